#include "palpable/live/sources/calibration_kind.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/live/calibrate/kalibr_camchain.h"
#include "palpable/live/calibrate/opencv_stereo_files.h"
#include "palpable/live/calibrate/realsense_file.h"
#include "palpable/live/calibrate/ros_camera_info.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>
#include <system_error>

namespace palpable {
namespace {

constexpr const char* kOwnForm =
    "write both eyes into one OpenCV YAML file with image_width image_height K1 D1 K2 D2 R T (m, "
    "x_right = R x_left + T), or make it with palpable calibrate";

bool begins_a_line(std::string_view text, std::string_view word) {
  return text.starts_with(word) || text.find("\n" + std::string(word)) != std::string_view::npos;
}

char first_character(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first == std::string_view::npos ? '\0' : text[first];
}

// Files of programs that are known but whose content is not enough, or of another kind of lens.
std::string whose_is_not_read(std::string_view text, const KeyedText& keys) {
  if (keys.has("model_type") &&
      (keys.has("projection_parameters") || keys.has("projection_parameters.fx") ||
       keys.has("mirror_parameters"))) {
    return fmt::format("is camodocal's file of one eye ({}), which is not read: {}",
                       keys.word("model_type"), kOwnForm);
  }
  if (keys.has("Camera.fx") || keys.has("Camera1.fx")) {
    return "is a settings file of ORB-SLAM, which is not read: for rectified pictures write "
           "rectified.yml (fx fy cx cy width height, baseline_m = Camera.bf / Camera.fx); else "
           "make a calibration with palpable calibrate";
  }
  if (keys.has("T_BS")) {
    return "is EuRoC's sensor.yaml of one camera: name the folder that holds cam0 and cam1 as "
           "--source";
  }
  if (text.find("[narrow_stereo") != std::string_view::npos ||
      (begins_a_line(text, "camera matrix") && begins_a_line(text, "projection"))) {
    return "is ROS's ost.txt (INI), which is not read: name left.yaml, which "
           "camera_calibration saves with it, or convert it (rosrun camera_calibration_parsers)";
  }
  if (begins_a_line(text, "P0:") || begins_a_line(text, "P_rect_")) {
    return "is KITTI's calib.txt, which is read in its folder: name the folder with image_0 and "
           "image_1 (or image_2 and image_3) as --source";
  }
  if (begins_a_line(text, "cam0=[")) {
    return "is Middlebury's calib.txt, which is read in its folder: name the folder with im0 and "
           "im1 as --source";
  }
  return {};
}

constexpr const char* kLookedFor =
    "is no calibration that is known; give another file, or make one with palpable calibrate. "
    "These "
    "were looked for: K1 D1 K2 D2 R T with image_width "
    "(palpable calibrate), M1 D1 M2 D2 and R T (OpenCV's intrinsics.yml and extrinsics.yml), "
    "camera_matrix and projection_matrix (ROS's left.yaml and right.yaml), cam0 and cam1 with "
    "camera_model (Kalibr), rectified.0.fx or Intrinsic of \"Depth\" (RealSense), [LEFT_CAM_HD] "
    "(ZED), fx with baseline_m (rectified.yml), four numbers fx fy cx cy (intrinsics.txt)";

std::optional<CalibrationKind> kind_by_keys(const KeyedText& keys) {
  if (is_ros_camera(keys)) return CalibrationKind::kRosCamera;
  if (is_camchain(keys)) return CalibrationKind::kCamchain;
  if (has_opencv_lenses(keys)) {
    return has_opencv_pose(keys) ? CalibrationKind::kOpencvRig : CalibrationKind::kOpencvLenses;
  }
  if (has_opencv_pose(keys)) return CalibrationKind::kOpencvPose;
  if (is_realsense_json(keys)) return CalibrationKind::kRealsenseJson;
  return std::nullopt;
}

// A line that begins with a word which intrinsics.txt does not have.
bool has_other_words(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.empty() || line.starts_with("color ") || line.starts_with("unit_m")) continue;
    const auto c = static_cast<unsigned char>(line.front());
    if (std::isalpha(c) != 0 || c == '<' || c == '{' || c == '%') return true;
  }
  return false;
}

CalibrationKind kind_of_text(const CalibrationText& file) {
  const std::string& text = file.text;
  const KeyedText& keys = file.keys;
  const char first = first_character(text);
  const bool is_yaml = first != '{' && first != '<';
  const bool has_size = keys.has("image_width") || begins_a_line(text, "image_width");
  const bool own_lenses = is_yaml && begins_a_line(text, "K1");
  if (own_lenses && (has_size || !has_opencv_lenses(keys))) return CalibrationKind::kRig;
  if (is_realsense_listing(text)) return CalibrationKind::kRealsenseListing;
  if (!whose_is_not_read(text, keys).empty()) return CalibrationKind::kNotRead;
  if (const auto kind = kind_by_keys(keys)) return *kind;
  if (text.find("[LEFT_CAM_") != std::string::npos || file.path.extension() == ".conf") {
    return CalibrationKind::kFactory;
  }
  if (first == '{') {
    return is_one_camera_json(keys) ? CalibrationKind::kCameraJson : CalibrationKind::kNotRead;
  }
  if (is_yaml && has_size && text.starts_with("%YAML")) return CalibrationKind::kRig;
  if (is_yaml &&
      (keys.has("baseline_m") || (text.starts_with("%YAML") && begins_a_line(text, "fx")))) {
    return CalibrationKind::kRectified;
  }
  const bool named_so = file.path.filename().string().ends_with("intrinsics.txt");
  return !named_so && has_other_words(text) ? CalibrationKind::kNotRead
                                            : CalibrationKind::kIntrinsics;
}

}  // namespace

Result<CalibrationText> open_calibration(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return Problem{fmt::format("calibration {} does not exist", path.string())};
  }
  Result<std::string> read = read_text_file(path, {.most = longest_text(Notation::kYaml)});
  if (!read) {
    return Problem{
        fmt::format("{} is no calibration file: {}", path.string(), read.problem().message)};
  }
  CalibrationText file;
  file.path = path;
  file.text = with_decimal_points(read.value());
  Result<KeyedText> keys = KeyedText::parse(file.text);
  if (!keys.ok()) {
    return Problem{fmt::format("calibration {}: {}", path.string(), keys.problem().message)};
  }
  file.keys = std::move(keys).value();
  file.kind = kind_of_text(file);
  if (file.kind == CalibrationKind::kIntrinsics) file.text = std::move(read).value();
  if (file.kind == CalibrationKind::kNotRead) {
    const std::string whose = whose_is_not_read(file.text, file.keys);
    file.not_read = whose.empty() ? kLookedFor : whose;
  }
  // OpenCV's reader wants the line with which its writer begins.
  const bool is_own =
      file.kind == CalibrationKind::kRig || file.kind == CalibrationKind::kRectified;
  if (is_own && !file.text.starts_with("%YAML")) file.text = "%YAML:1.0\n---\n" + file.text;
  return file;
}

bool is_half(CalibrationKind kind) {
  return kind == CalibrationKind::kOpencvLenses || kind == CalibrationKind::kOpencvPose ||
         kind == CalibrationKind::kRosCamera;
}

}  // namespace palpable
