/// @file
/// The velocities of pressers, and their extrapolation to times between two frames of the camera.
///
/// The displacement w of a surface since the previous frame is found from sample points p on the
/// visible side of the balls. With n the surface's normal at p, and phi_before the signed distance
/// to the surface of the previous frame,
///
///     n . w  =  phi_before(p)                        m
///
/// determines w along n. The displacement w_i of ball i fits the samples of all balls j around it,
/// weighted by their nearness k. What these leave undetermined (a straight finger that slides along
/// its axis) is taken from the displacement w_all of all balls together:
///
///     w_i = argmin  sum_j k(|c_i - c_j|) sum_p (n_p . w - phi_before(p))^2  +  e |w - w_all|^2
///
/// Three steps of Newton's method are made, since phi_before is not linear; in the last two,
/// samples with residuals of millimetres have small weights. The velocity follows half of a change
/// of the displacement at once, since measurements scatter, and more of a change above
/// settings.noise / 2.
///
/// With several things, told apart by the caller, the sums are over the balls of one thing, and
/// w_all is that of each.
///
/// During the time t after a frame a ball advances by  v T (1 - exp(-t / T)), T = settings.fades,
/// since hands that press slow down.
///
/// Body frame, m, s.
#pragma once

#include "palpable/common/contact/pressing_surface.h"
#include "palpable/live/seen_object/ball_tree.h"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct SurfaceMotionSettings {
  /// m: the distance at which a ball's samples no longer influence another ball. Larger values
  /// average more noise; smaller ones keep the fingers of a hand apart.
  double around = 0.025;
  /// m: a displacement that differs by this or more from the expected one is used at once, without
  /// smoothing.
  double noise = 0.0010;
  /// m: the largest displacement in one frame; samples with larger residuals are left out.
  double reach = 0.010;
  /// s: the time T in which an extrapolated velocity falls to 1/e, because hands that press slow
  /// down. In films of a finger that presses and one that slides, 1/30 s is better than 2/30 and
  /// than no decay (`palpable bench ticks`).
  double fades = 1.0 / 30;
};

/// Estimates the velocities of a sequence of surfaces. Keeps its memory.
class SurfaceMotion {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit SurfaceMotion(const SurfaceMotionSettings& settings = {});

  /// Adds the next frame's surface. If the time since the last one is not positive or is more than
  /// 0.2 s, the estimate begins anew with velocity 0.
  /// @param balls   of the surface (ObjectSurface::balls); held ones (unseen_for > 0) do not move
  /// @param camera  m, the camera's position
  /// @param time    s, of the frame
  /// @param things  of each ball the number of its thing, from 0 on; empty: all are of one
  void add(std::span<const ObjectBall> balls, const Eigen::Vector3f& camera, double time,
           std::span<const int> things = {});
  /// Takes over what another one found of a frame.
  /// @param velocities  m/s, of each ball  @param interval  s
  void take(std::span<const ObjectBall> balls, std::span<const Eigen::Vector3f> velocities,
            double interval);

  /// The velocity of each ball added last, m/s.
  [[nodiscard]] std::span<const Eigen::Vector3f> velocities() const { return velocities_; }
  /// What was measured of each ball added last since the frame before, not smoothed.
  struct Way {
    Eigen::Vector3f way = Eigen::Vector3f::Zero();  ///< m
    /// Whether its thing was seen in the frame before, so that w_all, at least, is known.
    bool is_seen = false;
    /// Whether its surroundings determine the way in each direction, more than w_all does.
    bool is_own = false;
  };
  [[nodiscard]] std::span<const Way> measured() const { return measured_; }
  /// s between the two frames last added; 0 while there is only one, or after a new beginning.
  [[nodiscard]] double interval() const { return interval_; }

  /// s: an extrapolated ball has advanced by its velocity times this, `seconds` after the frame.
  [[nodiscard]] double reached(double seconds) const;
  /// Extrapolates the balls to `seconds` after the frame added last. @param balls  overwritten
  void carry(double seconds, std::vector<ObjectBall>& balls) const;

 private:
  // Normal equations A w = b of the samples on one ball.
  struct BallEquations {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    Eigen::Matrix3f A = Eigen::Matrix3f::Zero();  // sum of n n^T
    Eigen::Vector3f b = Eigen::Vector3f::Zero();  // sum of n (n . w)
    int thing = 0;
    bool is_own = false;  // Way::is_own of balls around it
  };
  void find_samples(const Eigen::Vector3f& camera);
  void solve();
  void solve_step(int step);
  void find_means();
  void find_velocities();
  [[nodiscard]] Eigen::Vector3f velocity_before_at(const Eigen::Vector3f& position) const;

  SurfaceMotionSettings settings_;
  std::optional<double> time_;  // of the frame before
  double interval_ = 0;
  std::vector<ObjectBall> balls_;
  std::vector<int> things_;  // of balls_
  std::vector<Ball> bare_;   // the measured ones of balls_
  std::vector<int> bare_things_;
  BallTree now_, before_;
  std::vector<Eigen::Vector3f> velocities_;         // m/s, per ball of balls_
  std::vector<Eigen::Vector3f> velocities_before_;  // m/s, per ball of before_
  std::vector<Eigen::Vector3f> ways_;               // m, displacements, per entry of equations_
  std::vector<Way> measured_;                       // per ball of balls_
  std::vector<BallEquations> of_things_;            // the sums over each thing
  std::vector<Eigen::Vector3f> means_;              // m, w_all of each thing
  struct Sample {
    Eigen::Vector3f at, normal;
    int of = 0;  // index of equations_
  };
  std::vector<Sample> samples_;
  std::vector<BallEquations> equations_;  // of the balls that were chosen
};

}  // namespace palpable
