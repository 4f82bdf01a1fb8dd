#include "palpable/live/sources/source_calibration.h"

#include "palpable/common/base/text_numbers.h"
#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/calibrate/factory_calibration.h"
#include "palpable/live/sources/calibration_partner.h"
#include "palpable/live/sources/depth_unit.h"
#include "palpable/live/sources/foreign_calibration.h"

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace palpable {
namespace {

// "fx fy cx cy", then, if the colour sensor has another position, the 12 numbers of
// color_from_depth.
Result<ColorSensor> read_color_sensor(const std::string& numbers,
                                      const std::filesystem::path& path) {
  if (has_decimal_commas(numbers)) {
    return Problem{fmt::format("{}: after 'color' it {}", path.string(), kDecimalCommas)};
  }
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
  if (n.size() == kLens) return color;
  using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  color.color_from_depth.matrix().topRows<3>() = Eigen::Map<const Rows>(n.data() + kLens);
  return color;
}

// The content of intrinsics.txt: its numbers, and its lines that begin with a word.
struct IntrinsicsText {
  std::vector<double> numbers;
  std::optional<ColorSensor> color;
  std::optional<double> unit;  // m per step of the depth
};

Result<IntrinsicsText> read_intrinsics_text(const std::filesystem::path& path) {
  const auto lines = read_lines(path);
  if (!lines) return Problem{fmt::format("{}: {}", path.string(), lines.problem().message)};
  constexpr std::string_view kColor = "color ";
  constexpr std::string_view kUnit = "unit_m";
  const auto twice = [&](const char* what) {
    return Problem{fmt::format("{} states {} twice, with different values", path.string(), what)};
  };
  IntrinsicsText result;
  std::string text;
  for (const std::string& line : lines.value()) {
    if (line.starts_with(kColor)) {
      const Result<ColorSensor> read = read_color_sensor(line.substr(kColor.size()), path);
      if (!read.ok()) return read.problem();
      if (result.color && !(*result.color == read.value())) return twice("its colour camera");
      result.color = read.value();
    } else if (line.starts_with(kUnit)) {
      const auto number = to_numbers(line.substr(kUnit.size()));
      if (number && number->size() == 2 && line.find(',') != std::string::npos) {
        return Problem{fmt::format("{}: after 'unit_m' it {}", path.string(), kDecimalCommas)};
      }
      if (!number || number->size() != 1) {
        return Problem{fmt::format("{}: after 'unit_m' should stand one number, m, such as 0.001",
                                   path.string())};
      }
      if (result.unit && *result.unit != number->front()) return twice("unit_m");
      result.unit = number->front();
    } else {
      text += line + "\n";
    }
  }
  if (has_decimal_commas(text)) {
    return Problem{fmt::format("{} {}", path.string(), kDecimalCommas)};
  }
  result.numbers = to_numbers(text).value_or(std::vector<double>{});
  return result;
}

Result<SourceCalibration> read_intrinsics(const std::filesystem::path& path) {
  const Result<IntrinsicsText> read = read_intrinsics_text(path);
  if (!read.ok()) return read.problem();
  std::vector<double> n = read.value().numbers;
  std::optional<double> unit = read.value().unit;
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
  calibration.file = path.string();
  FrameFormat& format = calibration.format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.depth_camera = {0, 0, n[0], n[1], n[2], n[3]};
  format.color_sensor = read.value().color;
  if (!(n[0] > 0 && n[1] > 0)) {
    return Problem{fmt::format("{} has focal lengths {} and {} px; they should be positive",
                               path.string(), n[0], n[1])};
  }
  if (n.size() > kFewest) {
    if (!is_image_side(n[4]) || !is_image_side(n[5])) {
      return Problem{fmt::format("{} has an image of {} x {} px", path.string(), n[4], n[5])};
    }
    set_size(format, static_cast<int>(n[4]), static_cast<int>(n[5]));
    if (auto problem = problem_with(calibration, BaselineRule::kUsual)) return *problem;
  }
  if (n.size() == kMost) {
    if (unit && *unit != n[6]) {
      return Problem{fmt::format("{} states the unit of depth twice: {} and {} m", path.string(),
                                 n[6], *unit)};
    }
    unit = n[6];
  }
  if (unit) {
    const std::string wrong = what_is_wrong_with_depth_unit(*unit);
    if (!wrong.empty()) return Problem{fmt::format("{} has {}", path.string(), wrong)};
  }
  calibration.depth_unit = unit;
  return calibration;
}

}  // namespace

Result<SourceCalibration> read_source_calibration(const std::filesystem::path& path, int width,
                                                  int height,
                                                  std::optional<FrameFormat::Kind> kind) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(path, error);
  const Result<CalibrationText> opened =
      is_folder ? calibration_in(path, kind) : open_calibration(path);
  if (!opened.ok()) return opened.problem();
  const CalibrationText& file = opened.value();
  switch (file.kind) {
    case CalibrationKind::kRig: {
      const Result<StereoCalibration> stereo = stereo_calibration_of(file.text, file.path);
      if (!stereo.ok()) return stereo.problem();
      return from_rig(stereo.value(), file.path.string());
    }
    case CalibrationKind::kRectified: {
      const Result<RectifiedCalibration> rectified = rectified_calibration_of(file.text, file.path);
      if (!rectified.ok()) return rectified.problem();
      return from_rectified(rectified.value(), file.path.string());
    }
    case CalibrationKind::kFactory: {
      const Result<StereoCalibration> factory = read_factory_calibration(file.path, width, height);
      if (!factory.ok()) return factory.problem();
      Result<SourceCalibration> calibration = from_rig(factory.value(), file.path.string());
      if (calibration.ok()) calibration.value().has_more_sizes = true;
      return calibration;
    }
    case CalibrationKind::kIntrinsics:
      return read_intrinsics(file.path);
    default:
      return read_foreign_calibration(file, width, height, kind);
  }
}

std::optional<Problem> problem_with(const SourceCalibration& calibration, BaselineRule rule,
                                    std::string_view if_meant) {
  const std::string wrong = what_is_wrong_with(calibration.format);
  if (!wrong.empty()) {
    return Problem{fmt::format("calibration {} cannot be used: {}", calibration.file, wrong)};
  }
  const std::optional<double> baseline = baseline_of(calibration.format);
  if (rule == BaselineRule::kAnyPossible || !baseline) return std::nullopt;
  const std::string unlikely = what_is_unlikely_about_baseline(*baseline);
  if (unlikely.empty()) return std::nullopt;
  return Problem{fmt::format("calibration {}: {}; {}", calibration.file, unlikely, if_meant)};
}

}  // namespace palpable
