#include "palpable/live/calibrate/foreign_lens.h"

#include "palpable/common/base/text_numbers.h"
#include "palpable/live/calibrate/calibration_check.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace palpable {
namespace {

// In small letters, with '_' for spaces and hyphens, and without pyrealsense2's "distortion.".
std::string normalised(std::string_view model) {
  std::string name(
      model.substr(model.find('.') == std::string_view::npos ? 0 : model.find('.') + 1));
  for (char& c : name) {
    c = c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return name;
}

}  // namespace

Result<DistortedCamera> lens_of_model(const PinholeCamera& pinhole,
                                      const std::vector<double>& coefficients,
                                      std::string_view model) {
  constexpr std::array<std::string_view, 14> kKnown{"",
                                                    "none",
                                                    "plumb_bob",
                                                    "radtan",
                                                    "radial_tangential",
                                                    "rational_polynomial",
                                                    "thin_prism",
                                                    "brown_conrady",
                                                    "modified_brown_conrady",
                                                    "pinhole",
                                                    "inverse_brown_conrady",
                                                    "brown",
                                                    "opencv",
                                                    "radial"};
  const std::string name = normalised(model);
  const auto zero_from = [&](std::size_t first) {
    return std::all_of(
        coefficients.begin() + static_cast<std::ptrdiff_t>(std::min(first, coefficients.size())),
        coefficients.end(), [](double k) { return k == 0; });
  };
  DistortedCamera lens{pinhole, {}};
  const bool inverse = name == "inverse_brown_conrady" || name == "modified_brown_conrady";
  if (std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end() || (inverse && !zero_from(0))) {
    return Problem{fmt::format(
        "has a lens of the model {}; only k1 k2 p1 p2 k3 (radtan, plumb_bob) are known here: "
        "calibrate with one of these, or rectify the pictures first",
        model)};
  }
  const std::size_t count = coefficients.size();
  if (count != 0 && count != 4 && count != 5 && count != 8 && count != 12 && count != 14) {
    return Problem{fmt::format("has a lens of {} numbers; k1 k2 p1 p2 [k3] are 4 or 5", count)};
  }
  if (!zero_from(lens.distortion.size())) {
    return Problem{fmt::format(
        "has a rational or thin-prism lens ({}), whose k4 to k6 or s1 to s4 are not 0; only k1 k2 "
        "p1 p2 k3 are known here: calibrate without CALIB_RATIONAL_MODEL (in ROS: plumb_bob), or "
        "run palpable calibrate on the same pictures of boards",
        model.empty() ? fmt::format("{} numbers", count) : std::string(model))};
  }
  std::copy_n(coefficients.begin(), std::min(count, lens.distortion.size()),
              lens.distortion.begin());
  return lens;
}

Result<PinholeCamera> camera_of_matrix(const std::vector<double>& K, std::string_view name,
                                       int width, int height) {
  if (K.size() != 9 || std::abs(K[1]) > 1e-9 * std::abs(K[0]) || K[3] != 0 || K[6] != 0 ||
      K[7] != 0 || K[8] != 1) {
    return Problem{fmt::format("has {} that is not fx 0 cx / 0 fy cy / 0 0 1", name)};
  }
  if (!std::isfinite(K[0]) || !std::isfinite(K[4])) {
    return Problem{fmt::format("has a focal length in {} that is not finite", name)};
  }
  if (!(K[0] > 0 && K[4] > 0)) {
    return Problem{fmt::format("has focal lengths of {} and {} px in {}: was it calibrated?", K[0],
                               K[4], name)};
  }
  return PinholeCamera{width, height, K[0], K[4], K[2], K[5]};
}

Result<PinholeCamera> with_size(PinholeCamera camera, double width, double height) {
  if (!is_image_side(width) || !is_image_side(height)) {
    return Problem{fmt::format("has an image of {} x {} px", width, height)};
  }
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  return camera;
}

Result<Rigid3> pose_of_rows(const std::vector<double>& n, std::string_view name) {
  const bool ends_well =
      n.size() == 12 || (n.size() == 16 && n[12] == 0 && n[13] == 0 && n[14] == 0 && n[15] == 1);
  if (!ends_well) {
    return Problem{fmt::format(
        "has {} of {} numbers; it should have 4 rows of 4, the last one 0 0 0 1", name, n.size())};
  }
  using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  Rigid3 pose = Rigid3::Identity();
  pose.matrix().topRows<3>() = Eigen::Map<const Rows>(n.data());
  pose.linear() = nearest_rotation(pose.linear());
  return pose;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& R) {
  constexpr double kRounding = 1e-12;
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kLargestRotationError) || R.determinant() < 0 || off <= kRounding) return R;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

double largest_distortion_px(const DistortedCamera& lens) {
  const PinholeCamera& camera = lens.pinhole;
  double largest = 0;
  for (const double u : {0.0, camera.width - 1.0}) {
    for (const double v : {0.0, camera.height - 1.0}) {
      const Eigen::Vector3d ray = camera.unproject(u, v, 1);
      largest = std::max(largest, (lens.project(ray) - Eigen::Vector2d(u, v)).norm());
    }
  }
  return largest;
}

}  // namespace palpable
