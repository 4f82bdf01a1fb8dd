#include "palpable/live/calibrate/calibration_file.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/output_file.h"
#include "palpable/live/calibrate/foreign_lens.h"
#include "palpable/live/calibrate/yaml_matrix.h"

#include <fmt/core.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {
namespace {

constexpr int kMostRows = 100;  // of a matrix; cameras have 3, lenses up to 14 numbers

// Thrown and caught in this file only.
struct Unusable {
  std::string why;
};

// A key of the first level that is there twice, with different values; empty if there is none.
// OpenCV would take the first one.
std::string stated_twice(const std::string& text) {
  std::map<std::string, std::string> values;
  std::string key, value;
  const auto is_other = [&] {
    if (key.empty()) return false;
    const auto [found, is_new] = values.emplace(key, value);
    return !is_new && found->second != value;
  };
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t colon = line.find(':');
    const bool is_key =
        colon != std::string::npos && std::isalpha(static_cast<unsigned char>(line[0]));
    if (!is_key) {
      value += line;
      continue;
    }
    if (is_other()) return key;
    key = line.substr(0, colon);
    value = line.substr(colon);
  }
  return is_other() ? key : std::string();
}

cv::FileStorage open_yaml(const std::string& text) {
  // OpenCV guesses the format from the first bytes and also reads others; only YAML is accepted.
  if (text.rfind("%YAML", 0) != 0) {
    throw Unusable{"is not OpenCV YAML: its first line should be %YAML:1.0"};
  }
  if (text.find('\0') != std::string::npos) throw Unusable{"is not text"};
  if (const std::string key = stated_twice(text); !key.empty()) {
    throw Unusable{fmt::format("states '{}' twice, with different values", key)};
  }
  return cv::FileStorage(
      text, cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
}

double read_number(const cv::FileStorage& file, const char* name,
                   std::optional<double> fallback = std::nullopt) {
  const cv::FileNode node = file[name];
  if (node.empty() && fallback) return *fallback;
  if (!node.isInt() && !node.isReal()) { throw Unusable{fmt::format("has no number '{}'", name)}; }
  return static_cast<double>(node);
}

int size_px(const cv::FileStorage& file, const char* name) {
  const double value = read_number(file, name);
  if (!(value >= 1 && value <= kLargestImageSide) || value != std::floor(value)) {
    throw Unusable{fmt::format("has {} = {}; it should be a whole number of pixels up to {}", name,
                               value, kLargestImageSide)};
  }
  return static_cast<int>(value);
}

std::vector<double> matrix(const cv::FileStorage& file, const char* name) {
  const cv::FileNode node = file[name];
  if (node.empty()) throw Unusable{fmt::format("has no matrix '{}'", name)};
  if (!node.isMap()) throw Unusable{fmt::format("has '{}', which is no matrix", name)};
  // Checked before OpenCV allocates memory, because a damaged file may contain any number.
  for (const char* side : {"rows", "cols"}) {
    const cv::FileNode count = node[side];
    if (!count.isInt() || static_cast<int>(count) < 1 || static_cast<int>(count) > kMostRows) {
      throw Unusable{
          fmt::format("has '{}', which is no matrix of 1 to {} {}", name, kMostRows, side)};
    }
  }
  cv::Mat m;
  cv::read(node, m, cv::Mat());
  if (m.empty() || m.channels() != 1 || m.dims != 2) {
    throw Unusable{fmt::format("has '{}', which is no matrix", name)};
  }
  cv::Mat numbers;
  m.convertTo(numbers, CV_64F);
  numbers = numbers.reshape(1, 1);
  return {numbers.begin<double>(), numbers.end<double>()};
}

std::vector<double> matrix(const cv::FileStorage& file, const char* name, std::size_t count) {
  std::vector<double> values = matrix(file, name);
  if (values.size() != count) {
    throw Unusable{
        fmt::format("has '{}' of {} numbers; it should have {}", name, values.size(), count)};
  }
  return values;
}

DistortedCamera read_lens(const cv::FileStorage& file, char eye, int width, int height) {
  const std::string k_name = {'K', eye};
  const std::string d_name = {'D', eye};
  const Result<PinholeCamera> pinhole =
      camera_of_matrix(matrix(file, k_name.c_str(), 9), k_name, width, height);
  if (!pinhole.ok()) throw Unusable{pinhole.problem().message};
  const Result<DistortedCamera> lens =
      lens_of_model(pinhole.value(), matrix(file, d_name.c_str()), {});
  if (!lens.ok()) throw Unusable{fmt::format("{} ({})", lens.problem().message, d_name)};
  return lens.value();
}

double frame_rate(const cv::FileStorage& file) {
  const double fps = read_number(file, "fps", 30.0);
  if (!(fps > 0 && fps <= 10000)) throw Unusable{fmt::format("has fps = {}", fps)};
  return fps;
}

StereoCalibration stereo_from(const cv::FileStorage& file) {
  const int width = size_px(file, "image_width");
  const int height = size_px(file, "image_height");
  StereoCalibration calibration;
  calibration.rig.left = read_lens(file, '1', width, height);
  calibration.rig.right = read_lens(file, '2', width, height);
  const std::vector<double> R = matrix(file, "R", 9);
  const std::vector<double> T = matrix(file, "T", 3);
  calibration.rig.right_from_left.linear() =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  calibration.rig.right_from_left.translation() = Eigen::Map<const Eigen::Vector3d>(T.data());
  calibration.frames_per_second = frame_rate(file);
  calibration.rate_is_stated = !file["fps"].empty();
  const std::string wrong = what_is_wrong_with(calibration.rig);
  if (!wrong.empty()) throw Unusable{"cannot be used: " + wrong};
  calibration.rig.right_from_left.linear() =
      nearest_rotation(calibration.rig.right_from_left.linear());
  return calibration;
}

RectifiedCalibration rectified_from(const cv::FileStorage& file) {
  RectifiedCalibration calibration;
  calibration.stereo.camera = {size_px(file, "width"),  size_px(file, "height"),
                               read_number(file, "fx"), read_number(file, "fy"),
                               read_number(file, "cx"), read_number(file, "cy")};
  calibration.stereo.baseline = read_number(file, "baseline_m");
  // d = x_L - x_R = f T / Z + (cx_L - cx_R), and Middlebury's doffs is cx_R - cx_L.
  calibration.stereo.disparity_at_infinity_px = -read_number(file, "doffs_px", 0.0);
  calibration.frames_per_second = frame_rate(file);
  calibration.rate_is_stated = !file["fps"].empty();
  const std::string wrong = what_is_wrong_with(calibration.stereo);
  if (!wrong.empty()) throw Unusable{"cannot be used: " + wrong};
  return calibration;
}

template <class T>
Result<T> read(const std::string& text, const std::filesystem::path& path,
               T (*parse)(const cv::FileStorage&)) {
  if (const auto unparsable = why_not_parsed(text, Notation::kYaml)) {
    return Problem{fmt::format("calibration {}: line {}: {}", path.string(), unparsable->line,
                               unparsable->what)};
  }
  std::string why;
  try {
    return parse(open_yaml(text));
  } catch (const Unusable& unusable) { why = unusable.why; } catch (const cv::Exception& e) {
    why = "is damaged: " + e.err;
  } catch (const std::exception& e) { why = std::string("is damaged: ") + e.what(); }
  for (char& c : why) {
    if (c == '\n') c = ' ';
  }
  return Problem{fmt::format("calibration {} {}", path.string(), why)};
}

}  // namespace

Result<StereoCalibration> stereo_calibration_of(const std::string& text,
                                                const std::filesystem::path& path) {
  return read(text, path, &stereo_from);
}

Result<RectifiedCalibration> rectified_calibration_of(const std::string& text,
                                                      const std::filesystem::path& path) {
  return read(text, path, &rectified_from);
}

Result<StereoCalibration> read_stereo_calibration(const std::filesystem::path& path) {
  const Result<std::string> text = read_bounded_text(path, Notation::kYaml);
  if (!text.ok()) return Problem{"calibration " + text.problem().message};
  return stereo_calibration_of(text.value(), path);
}

Result<RectifiedCalibration> read_rectified_calibration(const std::filesystem::path& path) {
  const Result<std::string> text = read_bounded_text(path, Notation::kYaml);
  if (!text.ok()) return Problem{"calibration " + text.problem().message};
  return rectified_calibration_of(text.value(), path);
}

void write_stereo_calibration(const std::filesystem::path& path,
                              const StereoCalibration& calibration) {
  const StereoRig& rig = calibration.rig;
  const std::string wrong = what_is_wrong_with(rig);
  PALPABLE_EXPECT(wrong.empty(), wrong.c_str());
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = rig.right_from_left.linear();
  const Eigen::Vector3d T = rig.right_from_left.translation();
  std::string text = "%YAML:1.0\n---\n";
  text += fmt::format("image_width: {}\nimage_height: {}\nfps: {}\n", rig.left.pinhole.width,
                      rig.left.pinhole.height, yaml_real(calibration.frames_per_second));
  text += yaml_matrix("K1", 3, 3, camera_matrix_rows(rig.left.pinhole));
  text += yaml_matrix("D1", 1, 5, rig.left.distortion);
  text += yaml_matrix("K2", 3, 3, camera_matrix_rows(rig.right.pinhole));
  text += yaml_matrix("D2", 1, 5, rig.right.distortion);
  text += yaml_matrix("R", 3, 3, std::vector<double>(R.data(), R.data() + 9));
  text += yaml_matrix("T", 3, 1, std::vector<double>(T.data(), T.data() + 3));
  write_whole_file(path, text);
}

void write_rectified_calibration(const std::filesystem::path& path,
                                 const RectifiedCalibration& calibration) {
  const RectifiedStereo& stereo = calibration.stereo;
  const std::string wrong = what_is_wrong_with(stereo);
  PALPABLE_EXPECT(wrong.empty(), wrong.c_str());
  const PinholeCamera& c = stereo.camera;
  write_whole_file(
      path,
      fmt::format("%YAML:1.0\n---\nwidth: {}\nheight: {}\nfps: {}\nfx: {}\nfy: {}\ncx: {}\n"
                  "cy: {}\nbaseline_m: {}\ndoffs_px: {}\n",
                  c.width, c.height, yaml_real(calibration.frames_per_second), yaml_real(c.fx_px),
                  yaml_real(c.fy_px), yaml_real(c.cx_px), yaml_real(c.cy_px),
                  yaml_real(stereo.baseline), yaml_real(-stereo.disparity_at_infinity_px)));
}

}  // namespace palpable
