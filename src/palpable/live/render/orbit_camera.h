/// @file
/// A camera that is moved around a body by the mouse.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

namespace palpable {

/// A camera that looks at `target` from a distance. All in the body frame, Z up.
struct OrbitCamera {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< m, body frame: the middle of the picture
  double azimuth = 0;    ///< rad about Z; 0 looks from -Y along +Y, positive moves the eye to +X
  double elevation = 0;  ///< rad above the floor, within +-kSteepest
  double distance = 1;   ///< m from eye to target

  static constexpr double kSteepest = 1.5;  ///< rad; at pi/2 the picture's up is not defined

  /// Position of the eye, m, body frame.
  [[nodiscard]] Eigen::Vector3d eye() const;
  /// Pose of the body in the camera (X right, Y down, Z forward).
  [[nodiscard]] Rigid3 camera_from_body() const;

  /// Turns by a movement of the mouse in px, so that the body follows the pointer. Stops at
  /// kSteepest and just above the floor.
  void turn(double dx_px, double dy_px);
  /// Moves nearer for positive steps of the wheel; the distance stays within 1/8 .. 8 times
  /// `usual_distance` (m).
  void zoom(double steps, double usual_distance);
};

/// A pinhole camera with the given vertical field of view, its principal point in the middle.
[[nodiscard]] PinholeCamera camera_of_view(int width, int height, double vertical_view_rad);

}  // namespace palpable
