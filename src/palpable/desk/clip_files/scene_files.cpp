#include "palpable/desk/clip_files/scene_files.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/nearest_word.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/body_scale.h"
#include "palpable/common/toml/toml_section.h"
#include "palpable/desk/clip_files/json_lines.h"
#include "palpable/desk/clip_files/text_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kLargestPosition = 100;  // m; a larger position was probably given in mm

Rigid3 pose_of_numbers(const std::vector<double>& n, const std::string& where) {
  for (const double value : n) {
    if (!std::isfinite(value)) throw Error(fmt::format("{}: {} is no place", where, value));
  }
  Rigid3 pose = Rigid3::Identity();
  if (n.size() == 6) {
    pose = upright_pose(n[0], n[1], n[2], n[3], n[4], n[5]);
  } else if (n.size() == 16) {
    const RigidRows rows = rigid_of_rows(n);
    if (!rows.is_rigid) {
      throw Error(
          fmt::format("{}: the 16 numbers are no rigid motion (R R^T differs from 1 by {:.2g}, det "
                      "R = {:.4g}); "
                      "give camera_from_body row by row, in metres",
                      where, rows.skew, rows.determinant));
    }
    pose = rows.pose;
  } else {
    throw Error(
        fmt::format("{}: {} numbers; a place has 6 (x y z in m, roll pitch yaw in degrees) or 16 "
                    "(camera_from_body row by row)",
                    where, n.size()));
  }
  if (!(pose.translation().z() > 0)) {
    throw Error(fmt::format("{}: the body would stand behind the camera (z = {} m)", where,
                            pose.translation().z()));
  }
  if (pose.translation().norm() > kLargestPosition) {
    throw Error(fmt::format("{}: the body would stand {:.3g} m away; places are in metres", where,
                            pose.translation().norm()));
  }
  return pose;
}

toml::table read_toml(const fs::path& path) {
  const std::string text = value_or_throw(read_bounded_text(path, Notation::kToml));
  try {
    return toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    throw Error(fmt::format("{}: line {}: {}", path.string(), error.source().begin.line,
                            std::string_view(error.description())));
  }
}

std::optional<Rigid3> pose_in(const toml::table& table, const std::string& where) {
  const toml::node* node = table.get("camera_from_body");
  if (node == nullptr) return std::nullopt;
  const toml::array* array = node->as_array();
  if (array == nullptr) throw Error(fmt::format("{}: camera_from_body is no array", where));
  std::vector<double> numbers;
  for (const toml::node& element : *array) {
    const auto value = element.value<double>();
    if (!value) throw Error(fmt::format("{}: camera_from_body holds what is no number", where));
    numbers.push_back(*value);
  }
  return pose_of_numbers(numbers, where + ": camera_from_body");
}

constexpr Range kAny{-std::numeric_limits<double>::infinity(),
                     std::numeric_limits<double>::infinity()};
const std::vector<std::string> kAnchors{"scene", "plane", "board", "place"};

// Whether a name may be used: names become parts of paths and of text files.
bool is_plain(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  });
}

std::string name_in(TomlSection& section, const std::vector<DescribedBody>& before) {
  std::string name = section.text("name");
  if (!is_plain(name)) {
    section.bad("name", fmt::format("is '{}', must be letters, digits, - and _", name));
  }
  for (const DescribedBody& other : before) {
    if (other.name == name) section.bad("name", fmt::format("'{}' is another body's, too", name));
  }
  return name;
}

int beside_in(TomlSection& section, const std::vector<DescribedBody>& before) {
  const std::string wanted = section.text("beside");
  std::vector<std::string> names;
  for (const DescribedBody& other : before) names.push_back(other.name);
  const auto at = std::find(names.begin(), names.end(), wanted);
  if (at != names.end()) return static_cast<int>(at - names.begin());
  const std::string guess = nearest_word(wanted, names);
  section.bad("beside",
              fmt::format("is '{}', which is no body above it{}", wanted,
                          guess.empty() ? "" : fmt::format("; did you mean '{}'?", guess)));
}

BodyPlace place_in(TomlSection& section, const std::vector<DescribedBody>& before) {
  BodyPlace place;
  const std::string anchor = section.choice("anchor", kAnchors, "scene");
  if (section.has("beside")) {
    if (section.has("anchor")) section.bad("beside", "and 'anchor' exclude each other");
    place.beside = beside_in(section, before);
  }
  if (anchor == "plane") place.anchor = Anchor::kPlane;
  if (anchor == "board") place.anchor = Anchor::kBoard;
  if (section.has("place") != (anchor == "place")) {
    section.bad("place", section.has("place") ? "needs anchor = \"place\" beside it"
                                              : "is missing: anchor = \"place\" needs it");
  }
  if (anchor == "place") {
    const std::vector<double> numbers = section.numbers("place", kAny);
    try {
      place.place = read_pose(fmt::format("{}", fmt::join(numbers, " ")), "place");
    } catch (const Error& error) { section.bad("place", error.what()); }
  }
  if (section.has("at")) {
    place.anchor_from_body.translation() = section.quantities("at", Quantity::kLength);
  }
  const double turn = section.number("turn", {-360, 360}, 0) * kDegree;
  if (turn != 0) {
    place.anchor_from_body.linear() =
        Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  return place;
}

std::optional<Rgb> color_in(TomlSection& section) {
  if (!section.has("color")) return std::nullopt;
  const std::vector<double> c = section.numbers("color", {0, 255});
  if (c.size() != 3) section.bad("color", "must be three numbers: red, green, blue, 0 to 255");
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(x)); };
  return Rgb{byte(c[0]), byte(c[1]), byte(c[2])};
}

DescribedBody body_in(TomlSection& section, const fs::path& folder,
                      const std::vector<DescribedBody>& before) {
  DescribedBody body;
  body.name = name_in(section, before);
  body.file = (folder / section.text("file")).lexically_normal();
  if (section.has("description")) {
    body.description = (folder / section.text("description")).lexically_normal();
  }
  if (section.has("method")) body.method = section.text("method");
  body.place = place_in(section, before);
  body.scale = section.number("scale", {kLeastScale, kMostScale}, 1);
  if (section.has("set")) body.set = section.texts("set");
  body.color = color_in(section);
  if (section.has("friction")) body.friction = section.number("friction", {0.0, 10.0});
  section.refuse_unknown();
  return body;
}

// A value of an option as a word of the command line.
std::string word_of(const toml::node& node, const std::string& file, const SceneOption& option) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  throw Error(fmt::format("{}:{}: '{}' must be a text, a number, true, false, or a list of these",
                          file, node.source().begin.line, option.name));
}

std::string full_path(const fs::path& path) {
  return fs::absolute(path).lexically_normal().string();
}

// The keys of a [[body]] that place it. @param bodies  of the scene
std::string place_text(const BodyPlace& place, const std::vector<DescribedBody>& bodies) {
  std::string text;
  if (place.beside >= 0) {
    text += fmt::format("beside = {}\n",
                        quoted_text(bodies[static_cast<std::size_t>(place.beside)].name));
  } else if (place.place) {
    text +=
        fmt::format("anchor = \"place\"\nplace = [{}]\n", fmt::join(row_major(*place.place), ", "));
  } else if (place.anchor) {
    text += fmt::format("anchor = \"{}\"\n", *place.anchor == Anchor::kPlane ? "plane" : "board");
  }
  const Eigen::Vector3d at = place.anchor_from_body.translation();
  if (at.norm() > 0) {
    text += fmt::format("at = [\"{} m\", \"{} m\", \"{} m\"]\n", at.x(), at.y(), at.z());
  }
  const Eigen::Matrix3d turned = place.anchor_from_body.linear();
  const double turn = std::atan2(turned(1, 0), turned(0, 0)) / kDegree;
  if (turn != 0) text += fmt::format("turn = {:.12g}\n", turn);
  return text;
}

double positive_number(const toml::table& table, const char* key, const std::string& path) {
  const toml::node* node = table.get(key);
  if (node == nullptr) throw Error(fmt::format("{}: has no {}", path, key));
  const std::optional<double> value = node->value<double>();
  if (!value || !std::isfinite(*value) || *value <= 0) {
    throw Error(fmt::format("{}: line {}: {} must be a number above 0", path,
                            node->source().begin.line, key));
  }
  return *value;
}

std::optional<PinholeCamera> camera_of(const toml::table& table) {
  const auto width = table["width"].value<int>(), height = table["height"].value<int>();
  const auto fx = table["fx"].value<double>(), fy = table["fy"].value<double>();
  const auto cx = table["cx"].value<double>(), cy = table["cy"].value<double>();
  if (!width || !height || !fx || !fy || !cx || !cy) return std::nullopt;
  return PinholeCamera{*width, *height, *fx, *fy, *cx, *cy};
}

// A TOML literal string ('''), as in all earlier files, if the name allows it, else a quoted one.
std::string file_name_text(const std::string& name) {
  const std::string quoted = quoted_text(name);
  const bool plain = quoted == '"' + name + '"' && name.find('\'') == std::string::npos;
  return plain ? "'''" + name + "'''" : quoted;
}

}  // namespace

Rigid3 upright_pose(double x, double y, double z, double roll, double pitch, double yaw) {
  Eigen::Matrix3d upright;  // columns: the body's axes in the camera
  upright << 1, 0, 0,       //
      0, 0, -1,             //
      0, 1, 0;
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = (Eigen::AngleAxisd(roll * kDegree, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(pitch * kDegree, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix() *
                  upright *
                  Eigen::AngleAxisd(yaw * kDegree, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

Rigid3 read_pose(const std::string& text, const std::string& option) {
  if (const auto numbers = to_numbers(text); numbers && !numbers->empty()) {
    return pose_of_numbers(*numbers, option);
  }
  std::error_code ignored;
  if (!fs::is_regular_file(text, ignored)) {
    throw Error(fmt::format("{} '{}': neither 6 or 16 finite numbers nor a file that can be read",
                            option, text));
  }
  if (fs::path(text).extension() == ".toml") {
    if (const auto pose = pose_in(read_toml(text), text)) return *pose;
    throw Error(fmt::format("{}: has no camera_from_body", text));
  }
  const auto lines = read_lines(text);
  if (!lines) throw Error(fmt::format("{}: {}", text, lines.problem().message));
  const auto numbers = to_numbers(fmt::format("{}", fmt::join(lines.value(), " ")));
  if (!numbers) throw Error(fmt::format("{}: holds what is no finite number", text));
  return pose_of_numbers(*numbers, text);
}

void write_scene_file(const fs::path& folder, const char* what, const Rigid3& camera_from_body,
                      double frames_per_second) {
  TextFile scene(folder / "scene.toml");
  scene.write(fmt::format(
      "# Where the {} stands: camera_from_body, row by row, in the first frame's rectified left\n"
      "# camera (m).\ncamera_from_body = [{:.12g}]\nfps = {}\n",
      what, fmt::join(row_major(camera_from_body), ", "), frames_per_second));
  scene.close();
}

SceneFile read_scene_file(const fs::path& path) {
  SceneFile scene;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return scene;
  const toml::table table = read_toml(path);
  scene.camera_from_body = pose_in(table, path.string());
  if (const toml::node* node = table.get("press_static")) {
    const auto press_static = node->value_exact<bool>();
    if (!press_static) {
      throw Error(fmt::format("{}: press_static is to be true or false", path.string()));
    }
    scene.press_static = *press_static;
  }
  if (const toml::node* node = table.get("friction")) {
    scene.friction = node->value<double>();
    if (!scene.friction || !(*scene.friction >= 0 && *scene.friction <= 10)) {
      throw Error(fmt::format("{}: friction is to be a number from 0 to 10", path.string()));
    }
  }
  return scene;
}

std::vector<DescribedBody> read_scene_description(const fs::path& path) {
  const std::string file = path.string();
  const std::string text = value_or_throw(read_bounded_text(path, Notation::kToml));
  const toml::table table = parse_toml(text, file);
  TomlSection whole(file, "", table);
  std::vector<DescribedBody> bodies;
  for (TomlSection& section : whole.sections("body")) {
    bodies.push_back(body_in(section, path.parent_path(), bodies));
  }
  for (const auto& [key, node] : table) {  // options: read_scene_options()
    if (!node.is_table() && !node.is_array_of_tables()) {
      static_cast<void>(whole.has(std::string(key.str()).c_str()));
    }
  }
  whole.refuse_unknown();
  if (bodies.empty()) throw Error(fmt::format("{}: has no [[body]]", file));
  return bodies;
}

std::vector<SceneOption> read_scene_options(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::string text = value_or_throw(read_bounded_text(path, Notation::kToml));
  const toml::table table = parse_toml(text, file);
  std::vector<SceneOption> options;
  for (const auto& [key, node] : table) {
    if (node.is_table() || node.is_array_of_tables()) continue;
    SceneOption option{std::string(key.str()), {}, static_cast<int>(key.source().begin.line)};
    if (const toml::array* array = node.as_array()) {
      for (const toml::node& element : *array)
        option.words.push_back(word_of(element, file, option));
    } else {
      option.words.push_back(word_of(node, file, option));
    }
    options.push_back(std::move(option));
  }
  std::sort(options.begin(), options.end(),
            [](const SceneOption& a, const SceneOption& b) { return a.line < b.line; });
  return options;
}

std::string scene_text(const std::vector<DescribedBody>& bodies) {
  std::string text;
  for (const DescribedBody& body : bodies) {
    text += fmt::format("[[body]]\nname = {}\nfile = {}\n", quoted_text(body.name),
                        quoted_text(full_path(body.file)));
    if (!body.description.empty()) {
      text += fmt::format("description = {}\n", quoted_text(full_path(body.description)));
    }
    if (!body.method.empty()) text += fmt::format("method = {}\n", quoted_text(body.method));
    text += place_text(body.place, bodies);
    if (body.scale != 1) text += fmt::format("scale = {}\n", body.scale);
    if (body.friction) text += fmt::format("friction = {}\n", *body.friction);
    if (!body.set.empty()) {
      std::vector<std::string> quoted;
      for (const std::string& one : body.set) quoted.push_back(quoted_text(one));
      text += fmt::format("set = [{}]\n", fmt::join(quoted, ", "));
    }
    if (const auto& color = body.color) {
      text += fmt::format("color = [{}, {}, {}]\n", color->r, color->g, color->b);
    }
    text += "\n";
  }
  return text;
}

std::vector<Rigid3> scene_from_bodies(const std::vector<DescribedBody>& bodies) {
  std::vector<Rigid3> poses;
  for (const DescribedBody& body : bodies) {
    const BodyPlace& at = body.place;
    if (at.beside < 0 && (at.anchor || at.place)) {
      throw Error(
          fmt::format("the body '{}' has an anchor of its own, which only images show", body.name));
    }
    const Rigid3 base =
        at.beside >= 0 ? poses[static_cast<std::size_t>(at.beside)] : Rigid3::Identity();
    poses.push_back(base * at.anchor_from_body);
  }
  return poses;
}

void expect_baked(const DescribedBody& body, const fs::path& scene) {
  std::error_code ignored;
  if (fs::exists(body.file, ignored)) return;
  const std::string how =
      body.description.empty()
          ? "bake it first (palpable bake --help)"
          : fmt::format("bake it first: palpable bake {}{} -o {}", body.description.string(),
                        body.method == "intrusive-pgd" ? " --intrusive" : "", body.file.string());
  throw Error(fmt::format("{}: the body '{}' of {} is not there; {}", body.file.string(), body.name,
                          scene.string(), how));
}

void write_truth_camera(const std::filesystem::path& path, const TruthCamera& camera) {
  PALPABLE_EXPECT(camera.camera && camera.baseline && camera.seed, "a whole truth is written");
  const PinholeCamera& view = *camera.camera;
  TextFile file(path);
  file.write(fmt::format(
      "# The rectified left camera at half size: px; baseline in m.\n"
      "width = {}\nheight = {}\nfx = {:.12g}\nfy = {:.12g}\ncx = {:.12g}\ncy = {:.12g}\n"
      "baseline_m = {:.12g}\nfps = {}\ndepth_unit_m = {}\nsequence = {}\nseed = {}\n"
      "body = {}\n",
      view.width, view.height, view.fx_px, view.fy_px, view.cx_px, view.cy_px, *camera.baseline,
      camera.frames_per_second, camera.depth_unit, quoted_text(camera.sequence), *camera.seed,
      file_name_text(camera.body)));
  file.close();
}

TruthCamera read_truth_camera(const std::filesystem::path& file) {
  const std::string path = file.string();
  const toml::table table = read_toml(file);
  TruthCamera camera;
  camera.depth_unit = positive_number(table, "depth_unit_m", path);
  camera.frames_per_second = positive_number(table, "fps", path);
  camera.camera = camera_of(table);
  camera.baseline = table["baseline_m"].value<double>();
  camera.sequence = table["sequence"].value_or(std::string());
  camera.seed = table["seed"].value<std::uint64_t>();
  camera.body = table["body"].value_or(std::string());
  return camera;
}

}  // namespace palpable
