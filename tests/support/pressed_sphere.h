/// @file
/// A finger that presses the top of a sphere with tables of touch, seen by a colour + depth camera.
#pragma once

#include "palpable/live/session/frame_loop.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/seen_wall.h"
#include "tests/support/some_touch_tables.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace palpable::test {

/// Pose of the sphere, 0.4 m in front of a camera that looks down on it by 30 degrees.
inline Rigid3 sphere_pose() {
  using Eigen::Vector3d;
  Rigid3 camera_from_body = Rigid3::Identity();
  // The body's Z axis is the camera's -Y, then tilted.
  camera_from_body.linear() = (Eigen::AngleAxisd(0.5, Vector3d::UnitX()) *
                               Eigen::AngleAxisd(-std::acos(0.0), Vector3d::UnitX()) *
                               Eigen::AngleAxisd(2 * std::acos(0.0), Vector3d::UnitX()))
                                  .toRotationMatrix();
  camera_from_body.translation() = Vector3d(0.01, 0.03, 0.40);
  return camera_from_body;
}

/// A frame with the fingertip `depth` m inside the sphere, with its hand, in front of a wall. (The
/// finger alone is too small in this picture to be accepted: PressingMaskSettings.)
inline Frame frame_with_finger(int number, double depth) {
  using Eigen::Vector3d;
  const DentedSphere sphere;
  const Rigid3 camera_from_body = sphere_pose();
  const double tip = 2 * sphere.radius - depth + 0.008;
  const std::vector<Capsule> hand{{camera_from_body * Vector3d(0, 0, tip),
                                   camera_from_body * Vector3d(0.01, 0, tip + 0.1), 0.008},
                                  {camera_from_body * Vector3d(-0.04, 0, tip + 0.02),
                                   camera_from_body * Vector3d(0.04, 0, tip + 0.02), 0.012}};
  Frame frame = frame_of_wall(number, 0);
  const DepthImage finger = depth_of(hand, wall_format().depth_camera);
  for (std::size_t i = 0; i < finger.size(); ++i) {
    if (std::isnan(finger.data()[i])) continue;
    frame.depth.data()[i] = finger.data()[i];
    frame.left.data()[i] = Rgb{220, 150, 120};
  }
  return frame;
}

/// Everything visible presses from the first frame on.
inline const SessionSettings kEverythingPresses{.press_static = true, .map = false};

/// A frame loop for the sphere with tables of touch. @param swings  it has inertia
inline FrameLoop touchable_sphere_loop(const SessionSettings& settings = kEverythingPresses,
                                       bool swings = false) {
  const ReducedBody body = DentedSphere{}.body();
  TouchTables tables = yielding_tables(body.surface);
  if (swings) tables.vibration = swinging_vibration(tables.shell.nodes());
  return std::move(FrameLoop::make(TouchableBody(body, std::move(tables)), sphere_pose(),
                                   wall_format(), settings)
                       .value());
}

}  // namespace palpable::test
