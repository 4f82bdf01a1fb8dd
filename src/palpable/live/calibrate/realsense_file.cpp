#include "palpable/live/calibrate/realsense_file.h"

#include "palpable/common/base/text_numbers.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace palpable {
namespace {

constexpr double kMillimetreHere = 1e-3;
constexpr int kMostSizes = 64;  // of one stream; devices have twenty

// The camera of a size, or of a usual one if none is given.
template <class Camera, class PinholeOf>
Result<Camera> camera_of_size(const std::vector<Camera>& cameras, const PinholeOf& pinhole_of,
                              std::string_view what, int width, int height) {
  const auto find = [&](int w, int h) {
    return std::find_if(cameras.begin(), cameras.end(), [&](const Camera& camera) {
      return pinhole_of(camera).width == w && pinhole_of(camera).height == h;
    });
  };
  if (cameras.empty()) return Problem{fmt::format("has no {}", what)};
  if (width > 0) {
    const auto found = find(width, height);
    if (found != cameras.end()) return *found;
    std::string sizes;
    for (const Camera& camera : cameras) {
      sizes += fmt::format("{}{} x {}", sizes.empty() ? "" : ", ", pinhole_of(camera).width,
                           pinhole_of(camera).height);
    }
    return Problem{fmt::format("has {} of {} px, not of {} x {}", what, sizes, width, height)};
  }
  for (const auto& [w, h] : {std::pair{1280, 720}, {848, 480}, {640, 480}}) {
    const auto found = find(w, h);
    if (found != cameras.end()) return *found;
  }
  return cameras.front();
}

const PinholeCamera& itself(const PinholeCamera& camera) { return camera; }

// ---- the Viewer's JSON -----------------------------------------------------------------------

std::vector<PinholeCamera> rectified_sizes(const KeyedText& json) {
  std::vector<PinholeCamera> cameras;
  for (int n = 0; n < kMostSizes; ++n) {
    const auto number = [&](const char* key) {
      return json.number(fmt::format("rectified.{}.{}", n, key)).value_or(0);
    };
    const auto camera = with_size({0, 0, number("fx"), number("fy"), number("ppx"), number("ppy")},
                                  number("width"), number("height"));  // unused ones are 0 x 0
    if (camera.ok()) cameras.push_back(camera.value());
  }
  return cameras;
}

// ---- what rs-enumerate-devices -c prints -------------------------------------------------------

struct ListedCamera {
  std::string stream;   // "Infrared 1"
  std::string formats;  // "{Y8}"
  DistortedCamera lens;
  std::string lens_model;
};

struct ListedPose {
  std::string from, to;
  Rigid3 to_from_from = Rigid3::Identity();
};

struct Listing {
  std::vector<ListedCamera> cameras;
  std::vector<ListedPose> poses;
};

// The texts between the quotes of a line, spaces within them as one.
std::vector<std::string> quoted_in(std::string_view line) {
  std::vector<std::string> texts;
  for (;;) {
    const std::size_t from = line.find('"');
    const std::size_t to = from == std::string_view::npos ? from : line.find('"', from + 1);
    if (to == std::string_view::npos) return texts;
    std::string text;
    for (const char c : line.substr(from + 1, to - from - 1)) {
      if (c != ' ' || (!text.empty() && text.back() != ' ')) text += c;
    }
    texts.push_back(text);
    line.remove_prefix(to + 1);
  }
}

// Sets what a line "  Width:   640" says.
void set_entry(ListedCamera& camera, std::string_view key, std::string_view value) {
  PinholeCamera& pinhole = camera.lens.pinhole;
  const auto numbers = to_numbers(value).value_or(std::vector<double>{});
  const double number = numbers.empty() ? 0 : numbers.front();
  if (key == "Width" && is_image_side(number)) pinhole.width = static_cast<int>(number);
  if (key == "Height" && is_image_side(number)) pinhole.height = static_cast<int>(number);
  if (key == "PPX") pinhole.cx_px = number;
  if (key == "PPY") pinhole.cy_px = number;
  if (key == "Fx") pinhole.fx_px = number;
  if (key == "Fy") pinhole.fy_px = number;
  if (key == "Distortion") camera.lens_model = value;
  if (key == "Coeffs") {
    std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 5),
                camera.lens.distortion.begin());
  }
}

std::string_view without_ends(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t#*/");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t") - from + 1);
}

// Rows of numbers after "Rotation Matrix:", then one after "Translation Vector:".
void add_to_pose(ListedPose& pose, std::vector<double>& rotation, std::string_view line) {
  constexpr std::string_view kTranslation = "Translation Vector:";
  if (line.starts_with(kTranslation)) {
    const auto t = to_numbers(line.substr(kTranslation.size()));
    if (!t || t->size() != 3 || rotation.size() != 9) return;
    pose.to_from_from.linear() = nearest_rotation(
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data()));
    pose.to_from_from.translation() = Eigen::Map<const Eigen::Vector3d>(t->data());
    return;
  }
  const auto row = to_numbers(line);
  if (row && row->size() == 3 && rotation.size() < 9) {
    rotation.insert(rotation.end(), row->begin(), row->end());
  }
}

Listing listing_of(std::string_view text) {
  constexpr std::size_t kMostEntries = 4096;
  Listing listing;
  std::vector<double> rotation;
  enum class Part { kNone, kCamera, kPose } part = Part::kNone;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = without_ends(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with("Intrinsic of") && listing.cameras.size() < kMostEntries) {
      const auto names = quoted_in(line);
      const std::size_t brace = line.find('{');
      listing.cameras.push_back(
          {names.empty() ? "" : names.front(),
           brace == std::string_view::npos ? "" : std::string(line.substr(brace)),
           {},
           ""});
      part = Part::kCamera;
    } else if (line.starts_with("Extrinsic from") && listing.poses.size() < kMostEntries) {
      const auto names = quoted_in(line);
      listing.poses.push_back({names.size() == 2 ? names[0] : "", names.size() == 2 ? names[1] : "",
                               Rigid3::Identity()});
      rotation.clear();
      part = Part::kPose;
    } else if (part == Part::kCamera) {
      const std::size_t colon = line.find(':');
      if (colon == std::string_view::npos) continue;
      set_entry(listing.cameras.back(), line.substr(0, colon),
                without_ends(line.substr(colon + 1)));
    } else if (part == Part::kPose) {
      add_to_pose(listing.poses.back(), rotation, line);
    }
  }
  return listing;
}

// Of a size that is there in raw form, too (Y16), the rectified one.
Result<ListedCamera> listed_camera(const Listing& listing, std::string_view stream, int width,
                                   int height) {
  std::vector<ListedCamera> cameras;
  for (const ListedCamera& camera : listing.cameras) {
    const PinholeCamera& p = camera.lens.pinhole;
    const bool is_raw = camera.formats == "{Y16}" && stream != "Depth";
    if (camera.stream == stream && !is_raw && p.width > 0 && p.height > 0) {
      cameras.push_back(camera);
    }
  }
  return camera_of_size(
      cameras,
      [](const ListedCamera& camera) -> const PinholeCamera& { return camera.lens.pinhole; },
      fmt::format("an Intrinsic of \"{}\"", stream), width, height);
}

bool is_without_distortion(const DistortedCamera& lens) {
  return std::all_of(lens.distortion.begin(), lens.distortion.end(),
                     [](double k) { return k == 0; });
}

// Infrared 2 from Infrared 1, whose place is the depth's.
std::optional<Rigid3> pose_of_infrared(const Listing& listing) {
  for (const char* from : {"Infrared 1", "Depth"}) {
    for (const ListedPose& pose : listing.poses) {
      if (pose.from == from && pose.to == "Infrared 2") return pose.to_from_from;
      if (pose.from == "Infrared 2" && pose.to == from) return pose.to_from_from.inverse();
    }
  }
  return std::nullopt;
}

}  // namespace

bool is_realsense_json(const KeyedText& text) {
  return text.has("baseline") && text.has("rectified.0.fx");
}

bool is_realsense_listing(std::string_view text) {
  return text.find("Intrinsic of \"") != std::string_view::npos &&
         text.find("PPX") != std::string_view::npos;
}

Result<RectifiedStereo> stereo_of_realsense(const KeyedText& json, int width, int height) {
  const auto camera = camera_of_size(rectified_sizes(json), itself, "a rectified.N", width, height);
  if (!camera.ok()) return camera.problem();
  const auto baseline = json.number("baseline");
  if (!baseline) return Problem{"has no number baseline (mm)"};
  return RectifiedStereo{camera.value(), kMillimetreHere * std::abs(*baseline), 0};
}

Result<DistortedCamera> depth_of_realsense(const KeyedText& json, int width, int height) {
  const auto camera = camera_of_size(rectified_sizes(json), itself, "a rectified.N", width, height);
  if (!camera.ok()) return camera.problem();
  return DistortedCamera{camera.value(), {}};
}

Result<RectifiedStereo> stereo_of_realsense(std::string_view text, int width, int height) {
  const Listing listing = listing_of(text);
  const auto left = listed_camera(listing, "Infrared 1", width, height);
  if (!left.ok()) return left.problem();
  const DistortedCamera& lens = left.value().lens;
  const auto right = listed_camera(listing, "Infrared 2", lens.pinhole.width, lens.pinhole.height);
  if (right.ok() && !(right.value().lens == lens)) {
    return Problem{
        "has other numbers for \"Infrared 1\" than for \"Infrared 2\": its pictures are "
        "not rectified; make a calibration with palpable calibrate"};
  }
  const std::optional<Rigid3> pose = pose_of_infrared(listing);
  if (!pose) return Problem{"has no Extrinsic from \"Infrared 1\" to \"Infrared 2\""};
  const Eigen::Vector3d t = pose->translation();
  constexpr double kOff = 1e-5;  // of what rectified pictures have; the text has six digits
  if (!is_without_distortion(lens) || !pose->linear().isIdentity(kOff) || std::abs(t.y()) > kOff ||
      std::abs(t.z()) > kOff) {
    return Problem{
        "describes infrared pictures that are not rectified; make a calibration with "
        "palpable calibrate"};
  }
  return RectifiedStereo{lens.pinhole, -t.x(), 0};
}

Result<DistortedCamera> depth_of_realsense(std::string_view text, int width, int height) {
  const auto camera = listed_camera(listing_of(text), "Depth", width, height);
  if (!camera.ok()) return camera.problem();
  const DistortedCamera& lens = camera.value().lens;
  return lens_of_model(lens.pinhole, {lens.distortion.begin(), lens.distortion.end()},
                       camera.value().lens_model);
}

namespace {

// The paths before ".fx" of all cameras in the file, "" for one at the top.
std::vector<std::string> cameras_in(const KeyedText& json) {
  std::vector<std::string> paths;
  for (const auto& [path, value] : json.entries()) {
    for (const std::string_view key : {"fx", "intrinsic_matrix"}) {
      if (path == key) paths.emplace_back();
      if (path.ends_with("." + std::string(key))) {
        paths.push_back(path.substr(0, path.size() - key.size()));
      }
    }
  }
  return paths;
}

bool names_depth(std::string path) {
  for (char& c : path) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return path.find("depth") != std::string::npos;
}

}  // namespace

bool is_one_camera_json(const KeyedText& json) { return !cameras_in(json).empty(); }

Result<DistortedCamera> camera_of_json(const KeyedText& json) {
  std::vector<std::string> paths = cameras_in(json);
  if (paths.size() > 1) std::erase_if(paths, [](const auto& path) { return !names_depth(path); });
  if (paths.size() != 1) {
    return Problem{
        "has several cameras, and not one of them with \"depth\" in its keys: write fx fy cx cy of "
        "the depth into intrinsics.txt"};
  }
  const auto number = [&](std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
      if (const auto value = json.number(paths.front() + key)) return *value;
    }
    return std::nan("");
  };
  PinholeCamera camera{
      0, 0, number({"fx"}), number({"fy"}), number({"ppx", "cx"}), number({"ppy", "cy"})};
  if (const auto m = json.numbers(paths.front() + "intrinsic_matrix")) {
    if (m->size() != 9 || (*m)[1] != 0 || (*m)[3] != 0 || (*m)[8] != 1) {
      return Problem{
          "has an intrinsic_matrix that is not fx 0 0 0 fy 0 cx cy 1 (column by column)"};
    }
    camera = {0, 0, (*m)[0], (*m)[4], (*m)[6], (*m)[7]};
  }
  if (!(camera.fx_px > 0 && camera.fy_px > 0 && std::isfinite(camera.cx_px) &&
        std::isfinite(camera.cy_px))) {
    return Problem{"has no numbers fx, fy, ppx and ppy (or cx and cy) of a camera"};
  }
  const auto sized = with_size(camera, number({"width"}), number({"height"}));
  if (!sized.ok()) return sized.problem();
  return lens_of_model(sized.value(),
                       json.numbers(paths.front() + "coeffs").value_or(std::vector<double>{}),
                       json.word(paths.front() + "model"));
}

}  // namespace palpable
