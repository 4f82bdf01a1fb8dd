// Middlebury: https://vision.middlebury.edu/stereo/data, and pairs with similar names
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

// The value of `key=` in Middlebury's calib.txt; nothing if there is none. It is empty if it is no
// list of numbers, or if there are two that differ.
std::optional<std::vector<double>> middlebury_value(const std::vector<std::string>& lines,
                                                    std::string_view key) {
  std::optional<std::vector<double>> found;
  for (const std::string& line : lines) {
    if (!line.starts_with(key) || line.substr(key.size(), 1) != "=") continue;
    std::string numbers = line.substr(key.size() + 1);
    std::replace_if(
        numbers.begin(), numbers.end(), [](char c) { return c == '[' || c == ']' || c == ';'; },
        ' ');
    const std::vector<double> read = to_numbers(numbers).value_or(std::vector<double>{});
    if (found && *found != read) return std::vector<double>{};
    found = read;
  }
  return found;
}

// Reads calib.txt of Middlebury's sets since 2014 and of ETH3D's pairs: cam0=[f 0 cx; 0 f cy; 0 0
// 1], doffs (px), baseline (mm), width, height. A problem when the file has another content.
Result<SourceCalibration> middlebury_calibration(const fs::path& path) {
  const std::vector<std::string> lines = lines_in(path);
  const std::vector<double> kNone;
  const auto one = [&](std::string_view key) {
    const std::vector<double> numbers = middlebury_value(lines, key).value_or(kNone);
    return numbers.size() == 1 ? numbers.front() : std::nan("");
  };
  const std::vector<double> K = middlebury_value(lines, "cam0").value_or(kNone);
  const double baseline = 1e-3 * one("baseline");
  const double doffs = one("doffs");
  const double width = one("width");
  const double height = one("height");
  if (K.size() != 9 || !std::isfinite(doffs) || !std::isfinite(baseline) || !is_image_side(width) ||
      !is_image_side(height)) {
    return Problem{fmt::format(
        "{} is no calib.txt of Middlebury: it should have cam0=[f 0 cx; 0 f cy; 0 0 1], doffs= "
        "(px), baseline= (mm), width= and height=, each once",
        path.string())};
  }
  const PinholeCamera camera{
      static_cast<int>(width), static_cast<int>(height), K[0], K[4], K[2], K[5]};
  if (const auto cam1 = middlebury_value(lines, "cam1")) {
    const std::vector<double>& right = *cam1;
    if (right.size() != 9) {
      return Problem{
          fmt::format("{}: cam1= should be 9 numbers, and stand there once", path.string())};
    }
    // doffs is cx1 - cx0, of files of half resolution rounded to a pixel.
    const bool same_doffs = std::abs(right[2] - K[2] - doffs) < 1.5;
    const PinholeCamera other{camera.width, camera.height, right[0], right[4], right[2], right[5]};
    if (!same_doffs || !what_contradicts(camera, other).empty()) {
      return Problem{fmt::format(
          "{}: cam1 contradicts cam0 and doffs={}: f {} and {} px, cx {} and {}, cy {} and {}",
          path.string(), doffs, K[0], right[0], K[2], right[2], K[5], right[5])};
    }
  }
  SourceCalibration calibration;
  calibration.file = path.string();
  calibration.format.already_rectified = true;
  calibration.format.rectified = {camera, baseline, -doffs};
  calibration.format.width = calibration.format.rectified.camera.width;
  calibration.format.height = calibration.format.rectified.camera.height;
  const std::string wrong = what_is_wrong_with(calibration.format);
  if (!wrong.empty())
    return Problem{fmt::format("calibration {} cannot be used: {}", path.string(), wrong)};
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
