#include "palpable/desk/clip_files/scene_description.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/nearest_word.h"
#include "palpable/common/toml/toml_section.h"
#include "palpable/desk/clip_files/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

namespace palpable {
namespace {

namespace fs = std::filesystem;

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
    section.bad("place", "goes with anchor = \"place\", and that with it");
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
  const double turn = section.number("turn", {-360, 360}, 0) * std::numbers::pi / 180;
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
  body.scale = section.number("scale", {1e-3, 1e3}, 1);
  if (section.has("set")) body.set = section.texts("set");
  body.color = color_in(section);
  section.refuse_unknown();
  return body;
}

}  // namespace

std::vector<DescribedBody> read_scene_description(const fs::path& path) {
  const std::string file = path.string();
  const std::string text = value_or_throw(read_bounded_text(path, Notation::kToml));
  const toml::table table = parse_toml(text, file);
  TomlSection whole(file, "", table);
  std::vector<DescribedBody> bodies;
  for (TomlSection& section : whole.sections("body")) {
    bodies.push_back(body_in(section, path.parent_path(), bodies));
  }
  whole.refuse_unknown();
  if (bodies.empty()) throw Error(fmt::format("{}: has no [[body]]", file));
  return bodies;
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
                        body.method.empty() ? "" : " --method " + body.method, body.file.string());
  throw Error(fmt::format("{}: the body '{}' of {} is not there; {}", body.file.string(), body.name,
                          scene.string(), how));
}

}  // namespace palpable
