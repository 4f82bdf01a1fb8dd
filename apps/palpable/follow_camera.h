/// @file
/// From where the map is looked at: behind and above the camera that makes it, following softly,
/// led aside by the mouse. Knows no clock: times come in.
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/rigid.h"
#include "palpable/render/orbit_camera.h"
#include "palpable/render/window.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>

namespace palpable::app {

/// Works in a frame whose Z is up and whose origin is the world's: the room frame.
class FollowCamera {
 public:
  /// @param up     world, unit: away from the floor
  /// @param reach  m, how far before the camera stands what it is about: the body
  FollowCamera(const Eigen::Vector3d& up, double reach);

  /// The camera is seen at `world_from_camera` at `time` (s, the source's). The view is at once
  /// where it belongs in the first call, and comes nearer by half in every 0.4 s.
  void follow(const Rigid3& world_from_camera, double time);

  /// Any button turns, the wheel zooms, R takes both back. Whether the view has changed.
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
  bool turning_ = false;
  double x_before_ = 0, y_before_ = 0;
};

/// Where to look at all of a room from: over the shoulder of the camera that went through it, such
/// that the points and the whole path are in the picture.
/// @param points  (3 x N) world, m; one in fifty on each side may be left out; N > 0
/// @param path    where the camera was; not empty
/// @param up      world, unit
[[nodiscard]] Rigid3 overview(const Eigen::Matrix3Xf& points, std::span<const Rigid3> path,
                              const Eigen::Vector3d& up, const PinholeCamera& camera);

/// Which way is up in a room, from the normals of its surface and a camera that looked at it, held
/// upright and pitched by up to 60 degrees down or 30 up: of the directions that such a camera
/// would call up, the mean of the normals around the one that has most of them around it. Floors,
/// tables and seats outnumber what leans.
/// @param normals  (3 x N) world, unit or 0
/// @return world, unit; against the camera's Y axis where there is nothing to go by
[[nodiscard]] Eigen::Vector3d up_of_room(const Eigen::Matrix3Xf& normals,
                                         const Rigid3& world_from_camera);

}  // namespace palpable::app
