#include "palpable/live/sources/source_calibration.h"

#include "palpable/common/base/text_numbers.h"
#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/calibrate/factory_calibration.h"
#include "palpable/live/calibrate/rectification.h"

#include <Eigen/LU>
#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace palpable {
namespace {

// Checks here, where the file is known, that the rig can be rectified.
Result<SourceCalibration> from_rig(const StereoCalibration& stereo,
                                   const std::filesystem::path& path) {
  const Result<RectifiedGeometry> geometry = rectify_rig(stereo.rig);
  if (!geometry.ok()) {
    return Problem{fmt::format("calibration {} cannot be used: {}", path.string(),
                               geometry.problem().message)};
  }
  SourceCalibration calibration;
  calibration.format.rig = stereo.rig;
  calibration.format.width = stereo.rig.left.pinhole.width;
  calibration.format.height = stereo.rig.left.pinhole.height;
  calibration.frames_per_second = stereo.frames_per_second;
  return calibration;
}

SourceCalibration from_rectified(const RectifiedCalibration& rectified) {
  SourceCalibration calibration;
  calibration.format.already_rectified = true;
  calibration.format.rectified = rectified.stereo;
  calibration.format.width = rectified.stereo.camera.width;
  calibration.format.height = rectified.stereo.camera.height;
  calibration.frames_per_second = rectified.frames_per_second;
  return calibration;
}

// "fx fy cx cy", then, if the colour sensor has another position, the 12 numbers of
// color_from_depth.
Result<ColorSensor> read_color_sensor(const std::string& numbers,
                                      const std::filesystem::path& path) {
  const std::vector<double> n = to_numbers(numbers).value_or(std::vector<double>{});
  constexpr std::size_t kLens = 4, kLensAndPose = 16;
  if (n.size() != kLens && n.size() != kLensAndPose) {
    return Problem{
        fmt::format("{}: after 'color' should stand `fx fy cx cy`, or these and the 12 numbers of "
                    "color_from_depth, row by row, m",
                    path.string())};
  }
  ColorSensor color;
  color.camera = {0, 0, n[0], n[1], n[2], n[3]};
  if (!(n[0] > 0 && n[1] > 0)) {
    return Problem{
        fmt::format("{}: the colour camera's focal lengths are {} and {} px; they "
                    "should be positive",
                    path.string(), n[0], n[1])};
  }
  if (n.size() == kLens) return color;
  using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  color.color_from_depth.matrix().topRows<3>() = Eigen::Map<const Rows>(n.data() + kLens);
  const Eigen::Matrix3d R = color.color_from_depth.linear();
  constexpr double kFarthestApart = 1;  // m; a larger value has a wrong unit
  const double apart = color.color_from_depth.translation().norm();
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= 1e-3) || R.determinant() < 0) {
    return Problem{fmt::format("{}: color_from_depth holds no rotation", path.string())};
  }
  if (!(apart <= kFarthestApart)) {
    return Problem{fmt::format("{}: colour and depth camera stand {} m apart; 1 m at most",
                               path.string(), apart)};
  }
  return color;
}

Result<SourceCalibration> read_intrinsics(const std::filesystem::path& path) {
  const auto lines = read_lines(path);
  if (!lines) return Problem{fmt::format("{} cannot be read", path.string())};
  constexpr std::string_view kColor = "color ";
  std::string text;
  std::optional<ColorSensor> color;
  for (const std::string& line : *lines) {
    if (line.starts_with(kColor)) {
      const Result<ColorSensor> read = read_color_sensor(line.substr(kColor.size()), path);
      if (!read.ok()) return read.problem();
      color = read.value();
    } else {
      text += line + "\n";
    }
  }
  std::vector<double> n = to_numbers(text).value_or(std::vector<double>{});
  constexpr std::size_t kFewest = 4;  // fx fy cx cy
  constexpr std::size_t kMost = 7;    // also width height unit_m
  if (n.size() == 9 && n[1] == 0 && n[3] == 0 && n[6] == 0 && n[7] == 0 && n[8] == 1) {
    n = {n[0], n[4], n[2], n[5]};
  }
  if (n.size() != kFewest && n.size() != 6 && n.size() != kMost) {
    return Problem{fmt::format(
        "{} should have the numbers `fx fy cx cy`, `... width height` or "
        "`... width height unit_m`; a stereo rig's is an OpenCV YAML file, which begins "
        "with %YAML:1.0",
        path.string())};
  }
  SourceCalibration calibration;
  FrameFormat& format = calibration.format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.depth_camera = {0, 0, n[0], n[1], n[2], n[3]};
  format.color_sensor = color;
  if (!(n[0] > 0 && n[1] > 0)) {
    return Problem{fmt::format("{} has focal lengths {} and {} px; they should be positive",
                               path.string(), n[0], n[1])};
  }
  if (n.size() > kFewest) {
    if (!is_image_side(n[4]) || !is_image_side(n[5])) {
      return Problem{fmt::format("{} has an image of {} x {} px", path.string(), n[4], n[5])};
    }
    set_size(format, static_cast<int>(n[4]), static_cast<int>(n[5]));
  }
  if (n.size() == kMost) {
    calibration.depth_unit = n[6];
    // A number outside 1 um to 1 m per step has a wrong unit.
    if (!(n[6] >= 1e-6 && n[6] <= 1)) {
      return Problem{fmt::format("{} has depth steps of {} m; a sensor in millimetres has 0.001",
                                 path.string(), n[6])};
    }
  }
  return calibration;
}

}  // namespace

Result<SourceCalibration> read_source_calibration(const std::filesystem::path& path, int width,
                                                  int height) {
  // A pipe would block for ever, and a recording named by mistake would be read to its end.
  constexpr std::uintmax_t kLargestFile = 1u << 20;  // bytes
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(path, error);
  if (is_file ? std::filesystem::file_size(path, error) > kLargestFile
              : std::filesystem::exists(path, error)) {
    return Problem{fmt::format("{} is no calibration file", path.string())};
  }
  if (path.extension() == ".conf") {
    const Result<StereoCalibration> factory = read_factory_calibration(path, width, height);
    if (!factory.ok()) return factory.problem();
    return from_rig(factory.value(), path);
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    std::error_code ignored;
    return Problem{
        fmt::format("calibration {} {}", path.string(),
                    std::filesystem::exists(path, ignored) ? "cannot be read" : "does not exist")};
  }
  std::string first;
  std::getline(in, first);
  if (!first.starts_with("%YAML")) return read_intrinsics(path);
  bool is_raw = false;
  for (std::string line; std::getline(in, line);) {
    is_raw |= line.starts_with("K1") || line.starts_with("image_width");
  }
  if (is_raw) {
    const Result<StereoCalibration> stereo = read_stereo_calibration(path);
    if (!stereo.ok()) return stereo.problem();
    return from_rig(stereo.value(), path);
  }
  const Result<RectifiedCalibration> rectified = read_rectified_calibration(path);
  if (!rectified.ok()) return rectified.problem();
  return from_rectified(rectified.value());
}

}  // namespace palpable
