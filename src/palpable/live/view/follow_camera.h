/// @file
/// The viewpoint ("eye") of the map's picture: behind and above the camera that makes the map. It
/// follows that camera smoothly, and is turned and zoomed by the mouse. Times are passed in, so
/// that a test can be the clock.
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
  /// @param reach  m from the camera to the body; the eye looks at a point half as far ahead
  FollowCamera(const Eigen::Vector3d& up, double reach);

  /// Moves the eye towards its usual position behind the camera, whose pose at `time` (s, of the
  /// source) is `world_from_camera`. The first call places it there; later ones halve its distance
  /// from there in every 0.4 s.
  void follow(const Rigid3& world_from_camera, double time);

  /// Any button turns the view (while several are held, the first one), the wheel zooms, R resets.
  /// Returns whether the view has changed.
  bool handle(const WindowEvent& event);

  [[nodiscard]] Rigid3 camera_from_world() const;

 private:
  Rigid3 room_from_world_ = Rigid3::Identity();
  double ahead_ = 0;     // m in front of the camera to the point that the eye looks at
  double distance_ = 0;  // m from that point to the eye, before zooming
  OrbitCamera orbit_;
  double heading_ = 0;  // rad, smoothed azimuth of the camera's direction
  double turned_ = 0;   // rad, added by the mouse
  std::optional<double> time_;
  MouseDrag drag_;
};

}  // namespace palpable
