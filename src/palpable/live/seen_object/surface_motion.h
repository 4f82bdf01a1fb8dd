/// @file
/// How what presses moves, and where it is between two frames of the camera.
///
/// Of each ball j the side that is seen says how far it has come since the frame before: a place p
/// on it, where the surface points along n, has come by
///
///     n . w  =  phi_before(p)                        w = way since then, m
///
/// phi_before is the signed distance to the surface of then. A ball's place is told by all balls
/// around it together, the nearer the more; what they leave open (how a straight finger slides
/// along itself) by the thing as a whole:
///
///     w_i = min  sum_j k(|c_i - c_j|) sum_p (n_p . w - phi_before(p))^2  +  e |w - w_all|^2
///
/// and by three steps of Newton's method, since phi_before bends; in the last two what is off by
/// millimetres counts little. Half of what a way has changed is believed at once, for what is seen
/// scatters; of a change larger than that, more.
///
/// A thing goes on by  v T (1 - exp(-t / T))  in t, since hands that press slow down.
///
/// Body frame, m, s. One surface after the other; keeps its memory.
#pragma once

#include "palpable/common/contact/object_ball.h"
#include "palpable/live/seen_object/ball_tree.h"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct SurfaceMotionSettings {
  double around = 0.025;  ///< m: balls that far away move together
  /// m: from here on a way in one frame is a move rather than noise, and believed at once.
  double noise = 0.0010;
  /// m: what has come farther in one frame is not the same place.
  double reach = 0.010;
  /// s, in which a velocity fades to 1/e: hands that press slow down. On films of a finger that
  /// presses and one that slides 1/30 s is better than 2/30 and than no end (`bench ticks`).
  double fades = 1.0 / 30;
};

class SurfaceMotion {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit SurfaceMotion(const SurfaceMotionSettings& settings = {});

  /// The next frame's surface. Time that does not pass, or passes by more than 0.2 s, begins anew:
  /// nothing moves.
  /// @param balls   of it (ObjectSurface::balls); those that nobody sees stand still
  /// @param camera  m, where it is seen from
  /// @param time    s, of the frame
  void add(std::span<const ObjectBall> balls, const Eigen::Vector3f& camera, double time);

  /// m/s, of each of these balls.
  [[nodiscard]] std::span<const Eigen::Vector3f> velocities() const { return velocities_; }
  /// s between the two frames last added; 0 when there were none.
  [[nodiscard]] double interval() const { return interval_; }

  /// The balls so many seconds after the frame added last. @param balls  overwritten
  void carry(double seconds, std::vector<ObjectBall>& balls) const;

 private:
  // Normal equations of a ball's places.
  struct Told {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    Eigen::Matrix3f A = Eigen::Matrix3f::Zero();  // sum of n n^T
    Eigen::Vector3f b = Eigen::Vector3f::Zero();  // sum of n (n . w)
  };
  void find_places(const Eigen::Vector3f& camera);
  void solve();
  [[nodiscard]] Eigen::Vector3f before_at(const Eigen::Vector3f& place) const;

  SurfaceMotionSettings settings_;
  std::optional<double> time_;  // of the frame before
  double interval_ = 0;
  std::vector<ObjectBall> balls_;
  std::vector<Ball> bare_;  // those that are seen
  BallTree now_, before_;
  std::vector<Eigen::Vector3f> velocities_;   // m/s
  std::vector<Eigen::Vector3f> seen_before_;  // m/s, of the balls of before_
  std::vector<Eigen::Vector3f> ways_;         // m, of each of the chosen balls
  struct Place {
    Eigen::Vector3f at, normal;
    int of = 0;  // which of told_
  };
  std::vector<Place> places_;
  std::vector<Told> told_;
};

}  // namespace palpable
