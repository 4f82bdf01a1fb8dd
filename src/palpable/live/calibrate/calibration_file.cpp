#include "palpable/live/calibrate/calibration_file.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/output_file.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <fmt/core.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace palpable {
namespace {

constexpr int kMostRows = 100;       // of a matrix; cameras have 3, lenses up to 14 numbers
constexpr int kLargestSide = 16384;  // px; larger values are mistakes or attacks

// Thrown and caught in this file only.
struct Unusable {
  std::string why;
};

cv::FileStorage open_yaml(const std::string& text) {
  // OpenCV guesses the format from the first bytes and also reads others; only YAML is accepted.
  if (text.rfind("%YAML", 0) != 0) {
    throw Unusable{"is not OpenCV YAML: its first line should be %YAML:1.0"};
  }
  if (text.find('\0') != std::string::npos) throw Unusable{"is not text"};
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
  if (!(value >= 1 && value <= kLargestSide) || value != std::floor(value)) {
    throw Unusable{fmt::format("has {} = {}; it should be a whole number of pixels up to {}", name,
                               value, kLargestSide)};
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
  const std::vector<double> K = matrix(file, k_name.c_str(), 9);
  if (std::abs(K[1]) > 1e-9 * std::abs(K[0]) || K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1) {
    throw Unusable{fmt::format("has {} that is not fx 0 cx / 0 fy cy / 0 0 1", k_name)};
  }
  const std::vector<double> D = matrix(file, d_name.c_str());
  if (D.size() != 4 && D.size() != 5 && D.size() != 8 && D.size() != 12 && D.size() != 14) {
    throw Unusable{
        fmt::format("has {} of {} numbers; k1 k2 p1 p2 [k3] are 4 or 5", d_name, D.size())};
  }
  DistortedCamera camera;
  camera.pinhole = {width, height, K[0], K[4], K[2], K[5]};
  for (std::size_t i = 0; i < D.size(); ++i) {
    if (i < camera.distortion.size()) {
      camera.distortion[i] = D[i];
    } else if (D[i] != 0) {
      throw Unusable{fmt::format(
          "has {} with a rational or thin-prism lens model; only k1 k2 p1 p2 k3 are supported, so "
          "calibrate without CALIB_RATIONAL_MODEL",
          d_name)};
    }
  }
  return camera;
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
  const std::string wrong = what_is_wrong_with(calibration.rig);
  if (!wrong.empty()) throw Unusable{"cannot be used: " + wrong};

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(calibration.rig.right_from_left.linear(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  // A matrix that is a rotation except for rounding is not changed, so that writing and reading
  // preserve every bit.
  if ((nearest - calibration.rig.right_from_left.linear()).cwiseAbs().maxCoeff() > 1e-12) {
    calibration.rig.right_from_left.linear() = nearest;
  }
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
  const std::string wrong = what_is_wrong_with(calibration.stereo);
  if (!wrong.empty()) throw Unusable{"cannot be used: " + wrong};
  return calibration;
}

template <class T>
Result<T> read(const std::filesystem::path& path, T (*parse)(const cv::FileStorage&)) {
  const Result<std::string> text = read_bounded_text(path, Notation::kYaml);
  if (!text.ok()) return Problem{"calibration " + text.problem().message};
  std::string why;
  try {
    return parse(open_yaml(text.value()));
  } catch (const Unusable& unusable) { why = unusable.why; } catch (const cv::Exception& e) {
    why = "is damaged: " + e.err;
  } catch (const std::exception& e) { why = std::string("is damaged: ") + e.what(); }
  for (char& c : why) {
    if (c == '\n') c = ' ';
  }
  return Problem{fmt::format("calibration {} {}", path.string(), why)};
}

// Formats a number so that YAML readers take it for a real number, with as many digits as it needs.
std::string real(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

template <class Numbers>
std::string yaml_matrix(std::string_view name, int rows, int columns, const Numbers& numbers) {
  std::vector<std::string> texts;
  for (const double value : numbers) texts.push_back(real(value));
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     name, rows, columns, fmt::join(texts, ", "));
}

std::vector<double> camera_matrix_rows(const PinholeCamera& c) {
  return {c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1};
}

std::string wrong_with(const PinholeCamera& camera, std::string_view name) {
  if (camera.width < 1 || camera.height < 1 || camera.width > kLargestSide ||
      camera.height > kLargestSide) {
    return fmt::format("the {} image is {} x {} px", name, camera.width, camera.height);
  }
  for (const double value : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) {
    if (!std::isfinite(value)) return fmt::format("a number of the {} camera is not finite", name);
  }
  // Fields of view from 170 degrees to 0.1 degrees; otherwise the numbers have a wrong unit.
  const double side = std::max(camera.width, camera.height);
  for (const double focal : {camera.fx_px, camera.fy_px}) {
    if (!(focal > 0.04 * side && focal < 600 * side)) {
      return fmt::format("the {} focal length is {} px, for an image of {} x {}", name, focal,
                         camera.width, camera.height);
    }
  }
  for (const double centre : {camera.cx_px, camera.cy_px}) {
    if (!(centre > -side && centre < 2 * side)) {
      return fmt::format("the {} principal point ({}, {}) px is far outside of the image", name,
                         camera.cx_px, camera.cy_px);
    }
  }
  return {};
}

// Whether the distortion folds the image over: whether its radial part
//
//     r (1 + k1 r^2 + k2 r^4 + k3 r^6)
//
// has its maximum before it reaches the middle of the image's left and right border. (Many usable
// calibrations fold in the corners, which does no harm.)
bool folds_over(const DistortedCamera& read_lens) {
  const double border = 0.5 * read_lens.pinhole.width / read_lens.pinhole.fx_px;
  const double k1 = read_lens.distortion[0];
  const double k2 = read_lens.distortion[1];
  const double k3 = read_lens.distortion[4];
  constexpr double kStep = 0.01;
  for (double r = 0; r < 100; r += kStep) {
    const double q = r * r;
    if (r * (1 + q * (k1 + q * (k2 + q * k3))) >= border) return false;
    if (1 + q * (3 * k1 + q * (5 * k2 + q * 7 * k3)) <= 0) return true;
  }
  return true;
}

constexpr double kShortestBaseline = 1e-3;  // m
constexpr double kLongestBaseline = 10.0;   // m
constexpr double kLargestAngle = 0.7;       // rad between the eyes; real rigs have a few hundredths

// A hint for the message if the baseline is plausible (up to 10 m) when read in millimetres.
const char* of_millimetres(double baseline) {
  return baseline > kLongestBaseline && baseline <= 1000 * kLongestBaseline
             ? " (this looks like millimetres: divide it by 1000)"
             : "";
}

std::string wrong_with_eyes(const StereoRig& rig) {
  for (const auto& [camera, name] :
       {std::pair{&rig.left, "left"}, std::pair{&rig.right, "right"}}) {
    std::string wrong = wrong_with(camera->pinhole, name);
    if (!wrong.empty()) return wrong;
    for (const double value : camera->distortion) {
      if (!std::isfinite(value) || std::abs(value) > 1e4) {
        return fmt::format("a distortion coefficient of the {} camera is {}", name, value);
      }
    }
  }
  for (const auto& [camera, name] :
       {std::pair{&rig.left, "left"}, std::pair{&rig.right, "right"}}) {
    if (folds_over(*camera)) {
      return fmt::format("the distortion of the {} camera folds the image over inside the picture",
                         name);
    }
  }
  if (rig.left.pinhole.width != rig.right.pinhole.width ||
      rig.left.pinhole.height != rig.right.pinhole.height) {
    return fmt::format("the left image is {} x {} and the right one {} x {}; they should be equal",
                       rig.left.pinhole.width, rig.left.pinhole.height, rig.right.pinhole.width,
                       rig.right.pinhole.height);
  }
  return {};
}

// Describes a fault of the pose between the eyes; empty if there is none.
std::string wrong_with_pose(const Rigid3& right_from_left) {
  const Eigen::Matrix3d R = right_from_left.linear();
  const Eigen::Vector3d T = right_from_left.translation();
  if (!R.allFinite() || !T.allFinite()) return "a number of R or T is not finite";
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= 1e-3) || R.determinant() < 0) {
    return fmt::format("R is not a rotation (R^T R differs from I by {:.2g}, det R = {:.3g})", off,
                       R.determinant());
  }
  const double angle = Eigen::AngleAxisd(R).angle();
  if (angle > kLargestAngle) {
    return fmt::format("the eyes look {:.0f} degrees apart; they should see the same things",
                       angle * 180 / EIGEN_PI);
  }
  if (!(T.norm() >= kShortestBaseline && T.norm() <= kLongestBaseline)) {
    return fmt::format("the eyes are {:.4g} m apart; T should be in metres, {} to {}{}", T.norm(),
                       kShortestBaseline, kLongestBaseline, of_millimetres(T.norm()));
  }
  // The right eye's centre in the left camera: x = -R^T T.
  const Eigen::Vector3d right_eye = -R.transpose() * T;
  if (std::abs(right_eye.x()) < std::max(std::abs(right_eye.y()), std::abs(right_eye.z()))) {
    return "the eyes do not stand side by side: T should point along X";
  }
  if (right_eye.x() < 0) {
    return "the right eye stands to the left of the left one: swap the images, or the signs of T";
  }
  return {};
}

}  // namespace

std::string what_is_wrong_with(const StereoRig& rig) {
  std::string wrong = wrong_with_eyes(rig);
  return wrong.empty() ? wrong_with_pose(rig.right_from_left) : wrong;
}

std::string what_is_wrong_with(const RectifiedStereo& stereo) {
  std::string wrong = wrong_with(stereo.camera, "rectified");
  if (!wrong.empty()) return wrong;
  if (!(stereo.baseline >= kShortestBaseline && stereo.baseline <= kLongestBaseline)) {
    return fmt::format("the baseline is {} m; it should be in metres, {} to {}{}", stereo.baseline,
                       kShortestBaseline, kLongestBaseline, of_millimetres(stereo.baseline));
  }
  if (!(std::abs(stereo.disparity_at_infinity_px) < stereo.camera.width)) {
    return fmt::format("the disparity at infinity is {} px, for an image {} wide",
                       stereo.disparity_at_infinity_px, stereo.camera.width);
  }
  return {};
}

Result<StereoCalibration> read_stereo_calibration(const std::filesystem::path& path) {
  return read(path, &stereo_from);
}

Result<RectifiedCalibration> read_rectified_calibration(const std::filesystem::path& path) {
  return read(path, &rectified_from);
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
                      rig.left.pinhole.height, real(calibration.frames_per_second));
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
      path, fmt::format("%YAML:1.0\n---\nwidth: {}\nheight: {}\nfps: {}\nfx: {}\nfy: {}\ncx: {}\n"
                        "cy: {}\nbaseline_m: {}\ndoffs_px: {}\n",
                        c.width, c.height, real(calibration.frames_per_second), real(c.fx_px),
                        real(c.fy_px), real(c.cx_px), real(c.cy_px), real(stereo.baseline),
                        real(-stereo.disparity_at_infinity_px)));
}

}  // namespace palpable
