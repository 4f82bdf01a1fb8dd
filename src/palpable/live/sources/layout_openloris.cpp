// OpenLORIS-Scene: https://lifelong-robotic-vision.github.io/dataset/scene
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColorFrame = "d400_color_optical_frame";
constexpr const char* kRobotFrame = "base_link";

// Lines of a YAML file below `key:`, which stands at the beginning of a line; empty without it.
std::string section_of(const std::vector<std::string>& lines, std::string_view key) {
  std::string section;
  bool within = false;
  for (const std::string& line : lines) {
    const bool is_indented = line.starts_with(' ') || line.starts_with('\t');
    if (!is_indented) within = line.starts_with(std::string(key) + ":");
    if (within) section += line + "\n";
  }
  return section;
}

// The text behind `key:`, to the end of the line or the comma; empty without it.
std::string value_of(const std::string& text, std::string_view key) {
  for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
    const bool begins =
        at == 0 || std::string_view(" \n\t{,\"").find(text[at - 1]) != std::string_view::npos;
    const std::size_t colon = at + key.size();
    if (!begins || colon >= text.size() || text[colon] != ':') continue;
    const std::size_t from = text.find_first_not_of(" \t\"", colon + 1);
    if (from == std::string::npos) return {};
    return text.substr(from, text.find_first_of(" ,\n\t\"}", from) - from);
  }
  return {};
}

// The numbers of the matrix `key`, whose data stand in brackets behind it; empty without them.
std::vector<double> matrix_of(const std::string& text, std::string_view key) {
  const std::size_t at = text.find(std::string(key) + ":");
  if (at == std::string::npos) return {};
  const std::size_t data = text.find("data:", at);
  if (data == std::string::npos) return {};
  const std::size_t from = text.find('[', data), to = text.find(']', data);
  if (from == std::string::npos || to == std::string::npos || to < from) return {};
  return to_numbers(std::string_view(text).substr(from, to - from)).value_or(std::vector<double>{});
}

// The colour camera of sensors.yaml. Its intrinsics stand in the order fx cx fy cy.
Result<SourceCalibration> color_camera(const fs::path& path, std::vector<std::string>& notes) {
  const std::string section = section_of(lines_in(path), kColorFrame);
  const std::vector<double> n = matrix_of(section, "intrinsics");
  const auto width = to_number(value_of(section, "width"));
  const auto height = to_number(value_of(section, "height"));
  if (n.size() != 4 || !width || !height || !is_image_side(*width) || !is_image_side(*height)) {
    return Problem{fmt::format(
        "{} has no {} with width, height and intrinsics (fx cx fy cy): name intrinsics.txt with "
        "--calibration",
        path.string(), kColorFrame)};
  }
  SourceCalibration calibration = lens_calibration({n[0], n[2], n[1], n[3]}, path.string());
  set_size(calibration.format, static_cast<int>(*width), static_cast<int>(*height));
  if (const auto rate = to_number(value_of(section, "fps")); rate && *rate > 0) {
    calibration.frames_per_second = *rate;
    calibration.rate_is_stated = true;
  }
  const std::vector<double> distortion = matrix_of(section, "distortion_coefficients");
  if (std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0; })) {
    notes.push_back(
        fmt::format("{}: the colour lens has a distortion, which is not removed", path.string()));
  }
  return calibration;
}

// Transforms of trans_matrix.yaml: (parent, child) -> parent_from_child.
std::map<std::pair<std::string, std::string>, Rigid3> transforms_in(const fs::path& path) {
  std::map<std::pair<std::string, std::string>, Rigid3> transforms;
  std::string item;
  const auto close = [&] {
    const std::string parent = value_of(item, "parent_frame");
    const std::string child = value_of(item, "child_frame");
    const auto pose = pose_of(matrix_of(item, "matrix"));
    if (!parent.empty() && !child.empty() && pose) transforms[{parent, child}] = *pose;
    item.clear();
  };
  for (const std::string& line : lines_in(path)) {
    const std::size_t first = line.find_first_not_of(" \t");
    const std::string_view rest = std::string_view(line).substr(std::min(first, line.size()));
    const bool begins = rest == "-" || rest.starts_with("- ");  // not a negative number
    if (begins) close();
    item += (begins ? " " + std::string(rest.substr(1)) : line) + "\n";
  }
  close();
  return transforms;
}

// robot_from_camera along the chain of transforms; nothing if none leads there.
std::optional<Rigid3> robot_from_color(const fs::path& path) {
  const auto transforms = transforms_in(path);
  std::map<std::string, Rigid3> found{{kRobotFrame, Rigid3::Identity()}};
  for (std::size_t round = 0; round <= transforms.size(); ++round) {
    for (const auto& [frames, parent_from_child] : transforms) {
      const auto& [parent, child] = frames;
      if (found.contains(parent)) {
        found.emplace(child, found.at(parent) * parent_from_child);
      } else if (found.contains(child)) {
        found.emplace(parent, found.at(child) * parent_from_child.inverse());
      }
    }
  }
  const auto color = found.find(kColorFrame);
  if (color == found.end()) return std::nullopt;
  return color->second;
}

}  // namespace

Recognised openloris(const fs::path& folder) {
  const bool has_aligned = is_there(folder / "aligned_depth.txt");
  const bool has_depth = has_aligned || is_there(folder / "depth.txt");
  if (!is_there(folder / "color.txt") || !has_depth) return std::nullopt;
  if (!has_aligned) {
    return Problem{fmt::format(
        "{} is laid out as OpenLORIS is but has no aligned_depth.txt: its depth.txt is in the "
        "view of the depth camera; fetch aligned_depth.txt and aligned_depth/, too",
        folder.string())};
  }
  Result<Recording> pairs = stamped_pairs(folder, "OpenLORIS", "color.txt", "aligned_depth.txt");
  if (!pairs.ok()) return pairs;
  Recording& recording = pairs.value();
  recording.depth_unit = 1e-3;
  recording.calibrates_color = true;
  if (is_there(folder / "sensors.yaml")) {
    Result<SourceCalibration> calibration = color_camera(folder / "sensors.yaml", recording.notes);
    if (calibration.ok()) {
      recording.calibration = std::move(calibration).value();
    } else {
      recording.calibration_trouble = calibration.problem().message;
    }
  }
  // The truth is the robot's, not the camera's.
  const std::optional<Rigid3> robot_from_camera = robot_from_color(folder / "trans_matrix.yaml");
  for (RecordedFrame& frame : recording.frames) {
    if (!frame.world_from_camera) continue;
    if (robot_from_camera) {
      frame.world_from_camera = *frame.world_from_camera * *robot_from_camera;
    } else {
      frame.world_from_camera.reset();
    }
  }
  return pairs;
}

}  // namespace palpable::layouts
