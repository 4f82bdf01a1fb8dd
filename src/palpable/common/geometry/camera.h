/// @file
/// Cameras and the stereo rig (paper Sec. 3.3, Figs. 4 and 5).
///
/// Camera frame: X right, Y down, Z forward, metres. Pixel (0, 0) is the centre of the first pixel.
/// Depth is Z, not distance.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

#include <array>

namespace palpable {

/// A camera without distortion: the mapping m = Pi(M) of Sec. 3.3.
///
///     u = fx X / Z + cx,   v = fy Y / Z + cy
struct PinholeCamera {
  int width = 0;   ///< px
  int height = 0;  ///< px
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;

  /// Pixel of a point; the domain is Z > 0 (the caller checks).
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& x_in_camera) const {
    return {fx_px * x_in_camera.x() / x_in_camera.z() + cx_px,
            fy_px * x_in_camera.y() / x_in_camera.z() + cy_px};
  }

  /// The point at `depth` (Z, m) on the ray of pixel (u, v).
  [[nodiscard]] Eigen::Vector3d unproject(double u_px, double v_px, double depth) const {
    return {(u_px - cx_px) / fx_px * depth, (v_px - cy_px) / fy_px * depth, depth};
  }

  /// The camera of the image that is reduced by `factor` in each direction by averaging blocks of
  /// pixels: the centre of the new pixel (0, 0) is the centre of the first block.
  [[nodiscard]] PinholeCamera scaled_down(int factor) const {
    const double f = factor;
    return {width / factor, height / factor,         fx_px / f,
            fy_px / f,      (cx_px + 0.5) / f - 0.5, (cy_px + 0.5) / f - 0.5};
  }

  friend bool operator==(const PinholeCamera&, const PinholeCamera&) = default;
};

/// A real lens: pinhole and Brown-Conrady distortion in OpenCV's order k1 k2 p1 p2 k3.
struct DistortedCamera {
  PinholeCamera pinhole;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3, dimensionless

  /// Pixel of a point through the distorting lens; the domain is Z > 0.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& x_in_camera) const;

  friend bool operator==(const DistortedCamera&, const DistortedCamera&) = default;
};

/// Two rigidly joined cameras before rectification: distorted and not quite parallel.
struct StereoRig {
  DistortedCamera left;
  DistortedCamera right;
  Rigid3 right_from_left = Rigid3::Identity();  ///< translation in m
};

/// The rig after rectification (Fig. 5): one pinhole camera for both eyes, rows aligned, so that a
/// point at depth Z has the disparity d = f T / Z.
struct RectifiedStereo {
  PinholeCamera camera;  ///< left eye; the right one differs by the baseline alone
  double baseline = 0;   ///< T in m, > 0
  /// x_L - x_R of a point at infinity: minus Middlebury's "doffs". 0 for most rigs, but not for
  /// some published pairs.
  double disparity_at_infinity_px = 0;

  /// Z = f T / d (Sec. 3.3), m; infinite or negative for a disparity at or below infinity's.
  [[nodiscard]] double depth(double disparity_px) const {
    return camera.fx_px * baseline / (disparity_px - disparity_at_infinity_px);
  }
  [[nodiscard]] double disparity_px(double depth) const {
    return camera.fx_px * baseline / depth + disparity_at_infinity_px;
  }
};

}  // namespace palpable
