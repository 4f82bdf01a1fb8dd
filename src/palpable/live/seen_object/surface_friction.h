/// @file
/// How what a camera sees moves along a skin: what friction needs to know of it.
///
/// The displacement of each ball since the frame before is that of surface_motion.h: the way along
/// the surface's normals, with that of neighbouring balls, or of the whole thing, where they leave
/// something open. A finger that slides along its own axis shows little of its way.
///
/// A camera's surface trembles. A ball therefore moves only by what exceeds three standard
/// deviations of its surface; the rest waits for the next frames (a backlash). So a thing that
/// rests does not creep, and one that moves slowly is not lost, but late by that much:
///
///     pending <- pending + w        way = pending (1 - 3 sigma / |pending|), or 0
///     pending <- pending - way
///
/// Friction fades in over six frames in which the motion is known, and fades out likewise: a skin
/// that is let go for one frame would spring back.
///
/// Body frame, m, s.
#pragma once

#include "palpable/live/seen_object/ball_tree.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/seen_object/surface_motion.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Keeps its memory.
class SurfaceFriction {
 public:
  SurfaceFriction();

  /// Sets motion and friction of the next frame's surface (ObjectSurface::set_motion()).
  /// @param surface  as it was built
  /// @param camera   m, the camera's position
  /// @param time     s, of the frame
  void add(ObjectSurface& surface, const Eigen::Vector3f& camera, double time);

 private:
  [[nodiscard]] Eigen::Vector3f pending_before_at(const Eigen::Vector3f& place) const;

  SurfaceMotion motion_;
  int known_ = 0;                         // frames with known motion, kFadeFrames at most
  BallTree before_;                       // the balls of the frame before,
  std::vector<Eigen::Vector3f> pending_;  // and what is left of their ways, m
  std::vector<Eigen::Vector3f> next_;     // the same of this frame
  std::vector<Eigen::Vector3f> ways_;
  std::vector<Ball> bare_;
};

}  // namespace palpable
