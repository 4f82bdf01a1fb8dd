#include "palpable/live/calibrate/calibration_check.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

constexpr double kShortestBaseline = 1e-3;  // m
constexpr double kLongestBaseline = 10.0;   // m
constexpr double kLargestAngle = 0.7;       // rad between the eyes; real rigs have a few hundredths
constexpr double kFarthestColor = 1;        // m between colour and depth sensor of one device

// The likely unit of a focal length that is no number of pixels.
const char* focal_unit(double focal) {
  if (!(focal > 0)) return "";
  return focal < 2 ? " (this looks like a share of the picture's width: multiply it by the width)"
                   : " (this looks like millimetres: divide it by the side of a pixel)";
}

// Whether the distortion folds the image over: whether its radial part
//
//     r (1 + k1 r^2 + k2 r^4 + k3 r^6)
//
// has its maximum before it reaches the middle of the image's left and right border. (Many usable
// calibrations fold in the corners, which does no harm.)
bool folds_over(const DistortedCamera& lens) {
  const double border = 0.5 * lens.pinhole.width / lens.pinhole.fx_px;
  const double k1 = lens.distortion[0];
  const double k2 = lens.distortion[1];
  const double k3 = lens.distortion[4];
  constexpr double kStep = 0.01;
  for (double r = 0; r < 100; r += kStep) {
    const double q = r * r;
    if (r * (1 + q * (k1 + q * (k2 + q * k3))) >= border) return false;
    if (1 + q * (3 * k1 + q * (5 * k2 + q * 7 * k3)) <= 0) return true;
  }
  return true;
}

std::string wrong_with_eyes(const StereoRig& rig) {
  for (const auto& [camera, name] :
       {std::pair{&rig.left, "left"}, std::pair{&rig.right, "right"}}) {
    std::string wrong = what_is_wrong_with(camera->pinhole, name);
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

// How far R^T R is from I; infinite for a mirror image or what is not finite.
double off_a_rotation(const Eigen::Matrix3d& R) {
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return std::isfinite(off) && R.determinant() > 0 ? off : INFINITY;
}

// The likely unit of a baseline that no camera has.
const char* baseline_unit(double baseline) {
  if (baseline < kShortestBaseline) {
    return " (was it in metres or in squares of a board, and divided by 1000?)";
  }
  return baseline <= 1000 * kLongestBaseline
             ? " (this looks like millimetres: divide it by 1000; if it is in squares of a board, "
               "multiply it by the side of one in m)"
             : "";
}

std::string wrong_with_length(double baseline) {
  if (baseline == 0) {
    return "the baseline is 0 metres, the eyes stand in one place: is one eye's calibration given "
           "twice?";
  }
  if (baseline >= kShortestBaseline && baseline <= kLongestBaseline) return {};
  return fmt::format("the eyes are {:.4g} m apart; the baseline should be in metres, {} to {}{}",
                     baseline, kShortestBaseline, kLongestBaseline, baseline_unit(baseline));
}

// Describes a fault of the pose between the eyes; empty if there is none.
std::string wrong_with_pose(const Rigid3& right_from_left) {
  const Eigen::Matrix3d R = right_from_left.linear();
  const Eigen::Vector3d T = right_from_left.translation();
  if (!R.allFinite() || !T.allFinite()) return "a number of R or T is not finite";
  if (!(off_a_rotation(R) <= kLargestRotationError)) {
    return fmt::format("R is not a rotation (R^T R differs from I by {:.2g}, det R = {:.3g})",
                       (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
                       R.determinant());
  }
  const double angle = Eigen::AngleAxisd(R).angle();
  if (angle > kLargestAngle) {
    return fmt::format("the eyes look {:.0f} degrees apart; they should see the same things",
                       angle * 180 / EIGEN_PI);
  }
  std::string wrong = wrong_with_length(T.norm());
  if (!wrong.empty()) return wrong;
  // The right eye's centre in the left camera: x = -R^T T.
  const Eigen::Vector3d right_eye = -R.transpose() * T;
  if (std::abs(right_eye.x()) < std::max(std::abs(right_eye.y()), std::abs(right_eye.z()))) {
    return "the eyes do not stand side by side: T should point along X";
  }
  if (right_eye.x() < 0) {
    return "the eyes are swapped: the right one stands to the left of the left one; swap the "
           "images, or turn the signs of T";
  }
  return {};
}

std::string wrong_with_depth(const FrameFormat& format) {
  std::string wrong = what_is_wrong_with(format.depth_camera, "depth");
  if (!wrong.empty() || !format.color_sensor) return wrong;
  const PinholeCamera& color = format.color_sensor->camera;
  if (color.width != format.width || color.height != format.height) {
    return fmt::format("the images are {} x {} but the colour camera is {} x {}", format.width,
                       format.height, color.width, color.height);
  }
  wrong = what_is_wrong_with(color, "colour");
  if (!wrong.empty()) return wrong;
  const Rigid3& color_from_depth = format.color_sensor->color_from_depth;
  if (!color_from_depth.matrix().allFinite()) {
    return "how the colour camera stands to the depth camera is not finite";
  }
  if (!(off_a_rotation(color_from_depth.linear()) <= kLargestRotationError)) {
    return "color_from_depth holds no rotation";
  }
  const double apart = color_from_depth.translation().norm();
  if (apart > kFarthestColor) {
    return fmt::format("colour and depth camera stand {:.4g} m apart; {} m at most{}", apart,
                       kFarthestColor,
                       apart > 3 ? " (this looks like millimetres: divide it by 1000)" : "");
  }
  return {};
}

}  // namespace

std::string what_is_wrong_with(const PinholeCamera& camera, std::string_view name) {
  if (std::min(camera.width, camera.height) < 1 ||
      std::max(camera.width, camera.height) > kLargestImageSide) {
    return fmt::format("the {} image is {} x {} px", name, camera.width, camera.height);
  }
  for (const double value : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) {
    if (!std::isfinite(value)) return fmt::format("a number of the {} camera is not finite", name);
  }
  // Fields of view from 170 degrees to 0.1 degrees; otherwise the numbers have a wrong unit.
  const double side = std::max(camera.width, camera.height);
  for (const double focal : {camera.fx_px, camera.fy_px}) {
    if (!(focal > 0.04 * side && focal < 600 * side)) {
      return fmt::format("the {} focal length is {} px, for an image of {} x {}{}", name, focal,
                         camera.width, camera.height, focal < side ? focal_unit(focal) : "");
    }
  }
  // Pixels are square, or twice as wide as high where two eyes share the width of one picture.
  constexpr double kMostStretched = 2.5;
  if (const double stretched = camera.fy_px / camera.fx_px;
      !(stretched < kMostStretched && stretched > 1 / kMostStretched)) {
    return fmt::format(
        "the {} focal lengths are {} and {} px across and down, where pixels are nearly square: is "
        "a digit wrong?",
        name, camera.fx_px, camera.fy_px);
  }
  if (camera.cx_px == 0 && camera.cy_px == 0) {
    return fmt::format("the {} principal point is (0, 0), the corner: was it not given?", name);
  }
  // The borders of the outer pixels, whose centres are at 0 and at the size less 1.
  const auto inside = [](double centre, int pixels) {
    return centre >= -0.5 && centre <= pixels - 0.5;
  };
  if (!inside(camera.cx_px, camera.width) || !inside(camera.cy_px, camera.height)) {
    return fmt::format(
        "the {} principal point ({}, {}) px lies outside of the image of {} x {}: are these the "
        "numbers of another size, or is a sign wrong?",
        name, camera.cx_px, camera.cy_px, camera.width, camera.height);
  }
  return {};
}

std::string what_is_wrong_with(const StereoRig& rig) {
  std::string wrong = wrong_with_eyes(rig);
  return wrong.empty() ? wrong_with_pose(rig.right_from_left) : wrong;
}

std::string what_is_wrong_with(const RectifiedStereo& stereo) {
  std::string wrong = what_is_wrong_with(stereo.camera, "rectified");
  if (!wrong.empty()) return wrong;
  if (!std::isfinite(stereo.baseline)) return "the baseline is not finite";
  if (stereo.baseline < 0) {
    return fmt::format(
        "the baseline is {:.4g}, where positive metres are wanted, so the eyes are swapped: swap "
        "the "
        "images, or the baseline's sign",
        stereo.baseline);
  }
  wrong = wrong_with_length(stereo.baseline);
  if (!wrong.empty()) return wrong;
  if (!(std::abs(stereo.disparity_at_infinity_px) < stereo.camera.width)) {
    return fmt::format("the disparity at infinity is {} px, for an image {} wide",
                       stereo.disparity_at_infinity_px, stereo.camera.width);
  }
  return {};
}

std::string what_is_wrong_with(const FrameFormat& format) {
  if (format.kind == FrameFormat::Kind::kColorDepth) return wrong_with_depth(format);
  return format.already_rectified ? what_is_wrong_with(format.rectified)
                                  : what_is_wrong_with(format.rig);
}

std::string what_contradicts(const PinholeCamera& left, const PinholeCamera& right) {
  const auto same_f = [](double l, double r) { return std::abs(r - l) < 0.01 * l; };
  if (!same_f(left.fx_px, right.fx_px)) {
    return fmt::format("f of the two eyes, {} and {} px", left.fx_px, right.fx_px);
  }
  if (!same_f(left.fy_px, right.fy_px)) {
    return fmt::format("fy of the two eyes, {} and {} px", left.fy_px, right.fy_px);
  }
  if (!(std::abs(right.cy_px - left.cy_px) < 1)) {
    return fmt::format("cy of the two eyes, {} and {} px", left.cy_px, right.cy_px);
  }
  return {};
}

std::string baseline_text(double baseline) {
  // More digits beside the bounds of what is usual, so that 9.99 mm is not 10.0 mm.
  const auto is_beside = [&](double bound) {
    const double off = std::abs(baseline / bound - 1);
    return off > 1e-6 && off < 0.01;
  };
  if (is_beside(kUsualShortestBaseline)) return fmt::format("{:.4g} mm", 1e3 * baseline);
  if (is_beside(kUsualLongestBaseline)) return fmt::format("{:.6g} m", baseline);
  return baseline < 0.2 ? fmt::format("{:.1f} mm", 1e3 * baseline)
                        : fmt::format("{:.3f} m", baseline);
}

std::string what_is_unlikely_about_baseline(double baseline) {
  constexpr double kRounding = 1e-9;  // of a baseline that is computed from a pose or a projection
  if (baseline >= kUsualShortestBaseline * (1 - kRounding) &&
      baseline <= kUsualLongestBaseline * (1 + kRounding)) {
    return {};
  }
  constexpr double kUsualSquare = 0.025;  // m
  if (baseline < kUsualShortestBaseline) {
    return fmt::format(
        "the eyes are {} apart, and 10 mm to 1 m are usual: its unit should be the metre; perhaps "
        "it was in metres or in squares of a board, and was divided by 1000",
        baseline_text(baseline));
  }
  return fmt::format(
      "the eyes are {2} apart, and 10 mm to 1 m are usual: its unit should be the metre. In "
      "squares of a board: multiply it by the side of one in m ({0:.4g} squares of 25 mm are "
      "{1:.1f} mm); in centimetres: divide it by 100",
      baseline, 1e3 * kUsualSquare * baseline, baseline_text(baseline));
}

}  // namespace palpable
