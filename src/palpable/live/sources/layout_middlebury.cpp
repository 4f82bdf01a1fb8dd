// Middlebury: https://vision.middlebury.edu/stereo/data, and pairs with similar names
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

// The value of `key=` in Middlebury's calib.txt; empty if there is none.
std::vector<double> middlebury_numbers(const std::vector<std::string>& lines,
                                       std::string_view key) {
  for (const std::string& line : lines) {
    if (!line.starts_with(key) || line.substr(key.size(), 1) != "=") continue;
    std::string numbers = line.substr(key.size() + 1);
    std::replace_if(
        numbers.begin(), numbers.end(), [](char c) { return c == '[' || c == ']' || c == ';'; },
        ' ');
    return to_numbers(numbers).value_or(std::vector<double>{});
  }
  return {};
}

// Reads calib.txt of Middlebury's sets since 2014 and of ETH3D's pairs: cam0=[f 0 cx; 0 f cy; 0 0
// 1], doffs (px), baseline (mm), width, height. A problem when the file has another content.
Result<SourceCalibration> middlebury_calibration(const fs::path& path) {
  const std::vector<std::string> lines = lines_in(path);
  const auto one = [&](std::string_view key) {
    const std::vector<double> numbers = middlebury_numbers(lines, key);
    return numbers.size() == 1 ? numbers.front() : std::nan("");
  };
  const std::vector<double> K = middlebury_numbers(lines, "cam0");
  const double baseline = 1e-3 * one("baseline");
  const double doffs = one("doffs");
  const double width = one("width");
  const double height = one("height");
  constexpr double kLongestBaseline = 10;  // m
  if (K.size() != 9 || !(K[0] > 0 && K[4] > 0) || !std::isfinite(doffs) ||
      !(baseline > 0 && baseline < kLongestBaseline) || !is_image_side(width) ||
      !is_image_side(height)) {
    return Problem{fmt::format(
        "{} is no calib.txt of Middlebury: it should have cam0=[f 0 cx; 0 f cy; 0 0 1], doffs= "
        "(px), baseline= (mm), width= and height=",
        path.string())};
  }
  SourceCalibration calibration;
  calibration.format.already_rectified = true;
  calibration.format.rectified = {
      {static_cast<int>(width), static_cast<int>(height), K[0], K[4], K[2], K[5]}, baseline, doffs};
  calibration.format.width = calibration.format.rectified.camera.width;
  calibration.format.height = calibration.format.rectified.camera.height;
  return calibration;
}

}  // namespace

// Recognises the pair im0 and im1, imL and imR, or view1 and view5.
Recognised middlebury(const fs::path& folder) {
  const std::vector<fs::path> images = images_in(folder);
  constexpr std::array kNames{std::pair{"im0", "im1"}, std::pair{"imL", "imR"},
                              std::pair{"view1", "view5"}};
  const auto called = [&](std::string_view stem) {
    return std::find_if(images.begin(), images.end(),
                        [&](const fs::path& image) { return image.stem() == stem; });
  };
  for (const auto& [left, right] : kNames) {
    const auto first = called(left);
    const auto second = called(right);
    if (first == images.end() || second == images.end()) continue;
    Recording recording;
    recording.layout = fmt::format("{} and {}", left, right);
    recording.frames.push_back({*first, *second, {}, {}});
    const fs::path calibration = first->parent_path() / "calib.txt";
    if (!is_there(calibration)) return recording;
    const Result<SourceCalibration> read = middlebury_calibration(calibration);
    if (read.ok()) {
      recording.calibration = read.value();
    } else {
      recording.calibration_trouble = read.problem().message;
    }
    return recording;
  }
  return std::nullopt;
}

}  // namespace palpable::layouts
