/// @file
/// The eye of the map's picture: behind and above the camera that makes the map, following it
/// softly, turned and zoomed by the mouse. Times are passed in, so that a test can be the clock.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/render/orbit_camera.h"
#include "palpable/live/render/window_events.h"
#include "palpable/live/view/mouse_drag.h"

#include <Eigen/Core>

#include <optional>

namespace palpable {

/// Works in the room frame (room_frame.h).
class FollowCamera {
 public:
  /// @param up     world, unit: away from the floor
  /// @param reach  m from the camera to the body: the eye looks at a point half as far ahead
  FollowCamera(const Eigen::Vector3d& up, double reach);

  /// Moves the eye towards its place behind the camera, which stands at `world_from_camera` at
  /// `time` (s, the source's). The first call puts it there; later ones halve its distance from
  /// there in every 0.4 s.
  void follow(const Rigid3& world_from_camera, double time);

  /// Any button turns (of several the first one, until it is released), the wheel zooms, R takes
  /// both back. Returns whether the view has changed.
  bool handle(const WindowEvent& event);

  [[nodiscard]] Rigid3 camera_from_world() const;

 private:
  Rigid3 room_from_world_ = Rigid3::Identity();
  double ahead_ = 0;     // m before the camera: what the eye looks at
  double distance_ = 0;  // m, the usual one
  OrbitCamera orbit_;
  double heading_ = 0;  // rad, the azimuth that looks where the camera looks
  double turned_ = 0;   // rad, by the mouse
  std::optional<double> time_;
  MouseDrag drag_;
};

}  // namespace palpable
