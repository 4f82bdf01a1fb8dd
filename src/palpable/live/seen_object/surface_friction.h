/// @file
/// How what a camera sees moves along a skin: what friction needs to know of it.
///
/// The displacement w of each ball since the frame before is what surface_motion.h measures of it,
/// not smoothed: the way along the surface's normals, with that of neighbouring balls, or of all
/// balls of its thing where they leave something open. A finger that slides along its own axis
/// shows little of its way. Of a thing that was not seen in the frame before, as after a gap of 0.2
/// s, the way of its middle is taken. Balls whose way is thus the mean of their thing are marked
/// (ObjectBall::way_is_mean).
///
/// A camera's surface trembles. A ball at rest therefore stays where it is until it is more than
/// three standard deviations of its surface away. Then it follows w, catches up with half of what
/// is pending in each frame, and rests again where it stands still:
///
///     rests:  pending <- pending exp(-dt / 1 s) + w,  way = 0     until |pending| > 3 sigma
///     moves:  way = w + pending / 2,  pending <- pending / 2      until |w| < sigma, pending ~ 0
///
/// So from rest all directions take three sigma, and a turn in motion none. What is pending is
/// forgotten in a second, since the measured displacements of a trembling surface do not cancel:
/// their sum drifts by some mm in 20 s. Motions of less than three sigma in a second are lost.
///
/// The friction of a thing fades in over six frames in which its motion is known, and fades out
/// likewise: a skin that is let go for one frame would spring back. A thing that is gone for some
/// frames keeps what is left of it.
///
/// Body frame, m, s.
#pragma once

#include "palpable/live/seen_object/ball_things.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/seen_object/surface_motion.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpable {

/// Keeps its memory.
class SurfaceFriction {
 public:
  SurfaceFriction();

  /// Sets motion and friction of the next frame's surface (ObjectSurface::set_motion()).
  /// @param surface  as it was built; the same object in each call, built once for each
  /// @param camera   m, the camera's position
  /// @param time     s, of the frame
  void add(ObjectSurface& surface, const Eigen::Vector3f& camera, double time);

  /// Velocities and interval of the last surface that had balls.
  [[nodiscard]] const SurfaceMotion& motion() const { return motion_; }

 private:
  // What is kept of a ball until the next frame.
  struct Memory {
    Eigen::Vector3f pending = Eigen::Vector3f::Zero();  // m
    bool moves = false;
    int known = 0;  // frames with known motion of its thing, kFadeFrames at most
  };
  [[nodiscard]] static Eigen::Vector3f follow(const Eigen::Vector3f& w, float sigma, float kept,
                                              Memory& memory);
  void find_seen();
  [[nodiscard]] int nearest_before(std::size_t thing) const;
  void find_jumps();
  void find_ways(const ObjectSurface& surface);
  void find_known();

  BallThings things_;
  SurfaceMotion motion_;
  int gone_ = 0;                                  // frames without any ball before this one
  std::vector<Memory> memory_;                    // of the balls
  std::vector<Memory> memory_before_;             // of those of ObjectSurface::before()
  std::vector<ObjectSurface::BallMotion> found_;  // of the balls
  std::vector<Eigen::Vector3f> centres_before_;   // m, of the things of the frame before
  std::vector<Eigen::Vector3f> jumps_;            // m, by thing: the way of its middle
  std::vector<int> known_;                        // by thing
  std::vector<char> seen_;                        // by thing: Way::is_seen of one of its balls
  std::vector<char> taken_;                       // by thing of the frame before
};

}  // namespace palpable
