/// @file
/// A tracked camera's measurement of a point, and its derivatives.
///
/// A sighting is (u, v, d): the pixel in the left image and the disparity, all in px of the full
/// rectified images. A colour + depth camera measures Z; an assumed baseline turns it into d.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

#include <cmath>

namespace palpable {

/// A pinhole camera and the baseline (m) with which it measures depth:
///
///     u = fx X / Z + cx,   v = fy Y / Z + cy,   d = fx T / Z + error        (Sec. 3.3)
///
/// The error of the disparities is 0 for a rig whose calibration is right. If one eye has turned by
/// a tenth of a degree since, all disparities are off by the same px, whatever the distance.
struct TrackCamera {
  PinholeCamera camera;
  double baseline = 0;            ///< T, m, > 0
  double disparity_error_px = 0;  ///< of measured disparities, the same in the whole picture

  /// (u, v, d) of a point with Z > 0 (the caller checks).
  [[nodiscard]] Eigen::Vector3d see(const Eigen::Vector3d& x_in_camera) const {
    const Eigen::Vector2d uv = camera.project(x_in_camera);
    return {uv.x(), uv.y(), disparity_at(x_in_camera.z())};
  }

  /// The disparity that is measured at a true depth Z in m, px.
  [[nodiscard]] double disparity_at(double Z) const {
    return camera.fx_px * baseline / Z + disparity_error_px;
  }

  /// The true depth at which a disparity is measured, m; d > disparity_error_px.
  [[nodiscard]] double depth_at(double d) const {
    return camera.fx_px * baseline / (d - disparity_error_px);
  }

  /// The depth that a depth image with that error shows at a true depth Z, m.
  [[nodiscard]] double measured_depth(double Z) const {
    return Z / (1 + Z * disparity_error_px / (camera.fx_px * baseline));
  }

  /// The point whose sighting is (u, v, d), camera frame; d > disparity_error_px.
  [[nodiscard]] Eigen::Vector3d point(const Eigen::Vector3d& uvd) const {
    return camera.unproject(uvd.x(), uvd.y(), depth_at(uvd.z()));
  }

  /// d(u, v, d) / dx at x_in_camera, (3 x 3) px/m.
  [[nodiscard]] Eigen::Matrix3d derivative(const Eigen::Vector3d& x_in_camera) const {
    const double w = 1 / x_in_camera.z();
    Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
    J(0, 0) = camera.fx_px * w;
    J(0, 2) = -camera.fx_px * x_in_camera.x() * w * w;
    J(1, 1) = camera.fy_px * w;
    J(1, 2) = -camera.fy_px * x_in_camera.y() * w * w;
    J(2, 2) = -camera.fx_px * baseline * w * w;
    return J;
  }

  friend bool operator==(const TrackCamera&, const TrackCamera&) = default;
};

struct Sighting {
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero();  ///< px; d is NaN when it was not measured
  double sigma = 1;                               ///< px, standard deviation of u and of v
  double sigma_d = 1;                             ///< px, standard deviation of d

  [[nodiscard]] bool has_disparity() const { return !std::isnan(uvd.z()); }
};

/// A small motion: translation (m), then rotation vector (rad).
using Twist = Eigen::Matrix<double, 6, 1>;

/// The part of a motion that is completed after `share` of its time, at constant rates of rotation
/// and translation. share > 1 extrapolates the motion.
[[nodiscard]] inline Rigid3 part_of(const Rigid3& motion, double share) {
  Eigen::AngleAxisd turn(motion.linear());
  turn.angle() *= share;
  Rigid3 part = Rigid3::Identity();
  part.linear() = turn.toRotationMatrix();
  part.translation() = share * motion.translation();
  return part;
}

/// `pose` followed by x -> exp(rotation) x + translation: the parametrisation of a step in all our
/// least squares. The rotation is normalised; without that, rounding would make products of
/// rotations noticeably non-orthogonal within seconds.
[[nodiscard]] inline Rigid3 moved_by(const Twist& step, const Rigid3& pose) {
  const Eigen::Vector3d rotation = step.tail<3>();
  const double angle = rotation.norm();
  const Eigen::Vector3d axis =
      angle > 0 ? Eigen::Vector3d(rotation / angle) : Eigen::Vector3d::UnitX();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, axis));
  Rigid3 result = Rigid3::Identity();
  result.linear() = (turn * Eigen::Quaterniond(pose.linear())).normalized().toRotationMatrix();
  result.translation() = turn * pose.translation() + step.head<3>();
  return result;
}

/// cross_matrix(v) x = v cross x.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// d(u, v, d) / d(step) of moved_by(step, camera_from_world) at step = 0, (3 x 6).
[[nodiscard]] inline Eigen::Matrix<double, 3, 6> pose_derivative(
    const Eigen::Matrix3d& derivative, const Eigen::Vector3d& x_in_camera) {
  Eigen::Matrix<double, 3, 6> J;
  J.leftCols<3>() = derivative;
  // d(exp(r) x) / dr = -[x]x
  J.rightCols<3>() = -derivative * cross_matrix(x_in_camera);
  return J;
}

}  // namespace palpable
