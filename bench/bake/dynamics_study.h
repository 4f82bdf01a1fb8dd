/// @file
/// How a body rings that is plucked and let go: the full mesh in time (solid/implicit_dynamics.h)
/// beside the oscillators of the vibration modes in its body file (response/vibration_table.h); and
/// the force of a thing that hits it.
///
///   m  modes
#pragma once

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/implicit_dynamics.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/common/response/vibration_table.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// A vertex of the skin, and the direction along which it is pulled and watched.
struct PluckedPlace {
  int vertex = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
};

/// Where the modes give way most to a force of 1 N, by sum_i (phi_i . d)^2 / omega_i^2: the tip of
/// an ear, across it.
[[nodiscard]] PluckedPlace softest_place(const SkinResponse& skin, const VibrationTable& modes);

/// (3 x N) N, 1 N at the place along its direction.
[[nodiscard]] Eigen::Matrix3Xd unit_pull(const SkinResponse& skin, const PluckedPlace& place);

/// Motion of the place along its direction, from the rest: m, at the times 0, h, 2 h ...
struct Ring {
  double time_step = 0;  ///< s, h
  std::vector<double> motion;
};

/// A ring of the full mesh.
struct FullRing {
  Ring ring;
  /// J: how far kinetic and elastic energy together ever rise above what they were before, although
  /// nothing works on the body; and the largest error of the balance with what damping took.
  double energy_rise = 0, balance_error = 0;
  double energy = 0;  ///< J above that of the rest, at the start
  int steps = 0, newton_steps = 0, cg_iterations = 0;
};

/// Lets the body go from rest in a state, until the place has passed its rest `crossings` times.
/// @param start    (3 x N) m, for instance the equilibrium under a pull
/// @param longest  s
[[nodiscard]] FullRing ring_in_full(ImplicitDynamics& dynamics, const SkinResponse& skin,
                                    const PluckedPlace& place, const Eigen::Matrix3Xd& start,
                                    double time_step, int crossings, double longest);

/// The ring of the live half (response/inertia.h) after a pull of `load` (N) that is gone at the
/// time 0. What the modes do not hold of the displacement is gone at once.
/// @param samples  of the ring
[[nodiscard]] Ring ring_of_modes(const VibrationTable& modes, const PluckedPlace& place,
                                 double load, double time_step, int samples);

/// s, times at which the motion passes 0, linear between samples.
[[nodiscard]] std::vector<double> zero_crossings(const Ring& ring);

/// m, rising time: the extreme of the motion between each zero crossing and the next, by a parabola
/// through three samples. The motion before the first crossing is not among them.
[[nodiscard]] std::vector<double> swings(const Ring& ring);

/// Zero crossings up to which rings are compared, and the one at which the phase is.
inline constexpr int kComparedCrossings = 6, kPhaseCrossing = 5;

/// How far a ring is from the true one, up to the last compared crossing.
struct RingDifference {
  double amplitude = 0;                 ///< the largest |a'/a - 1| of the swings
  std::vector<double> amplitudes = {};  ///< a'/a - 1 of each swing
  double phase = 0;   ///< by how many true periods crossing kPhaseCrossing is late; negative: early
  double period = 0;  ///< s, of the true ring, the mean from the first crossing on
  double trace = 0;   ///< relative L2 of the motion from the first true crossing on
};

/// @throws Error if one of them has fewer crossings
[[nodiscard]] RingDifference ring_difference(const Ring& ring, const Ring& truth);

/// A thing that comes at a constant speed, just touches the body at the time 0, is stopped at a
/// depth and stays there.
struct Hit {
  TouchScene scene;
  double speed = 0.2;    ///< m/s
  double depth = 0.005;  ///< m, how far it goes in
};

/// Its pose. @param t  s; before 0 as at 0
[[nodiscard]] Obstacle obstacle_of(const Hit& hit, double t);

/// (samples) N, the force of the thing on the full mesh, without friction, at the ends of the steps
/// from rest.
/// @param spacing  m, between contact points
[[nodiscard]] std::vector<Eigen::Vector3d> hit_in_full(ImplicitDynamics& dynamics, const Hit& hit,
                                                       double spacing, int samples);

/// (frames) N, the force of the thing by the live half, which is called at the ends of frames.
/// @param body   with tables that have vibration modes
/// @param frame  s
[[nodiscard]] std::vector<Eigen::Vector3d> hit_live(const TouchableBody& body, const Hit& hit,
                                                    double frame, int frames);

/// N, the mean of each group of `count` samples that follow each other; what is left over at the
/// end is dropped. Contact makes the force jump from step to step.
[[nodiscard]] std::vector<Eigen::Vector3d> means_of_groups(
    const std::vector<Eigen::Vector3d>& forces, int count);

/// N, the largest size of a force; 0 of none.
[[nodiscard]] double peak_of(const std::vector<Eigen::Vector3d>& forces);

/// The relative L2 difference of forces over time. @pre equally many
[[nodiscard]] double difference_of(const std::vector<Eigen::Vector3d>& forces,
                                   const std::vector<Eigen::Vector3d>& truth);

}  // namespace palpable
