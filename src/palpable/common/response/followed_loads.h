/// @file
/// The loads under which the nonlinear terms of a body with inertia are evaluated.
///
/// The tables know these terms of static bodies, as functions of the loads (nonlinear_response.h).
/// A load that has just begun to move an ear has not bent it yet, and an ear that was let go is
/// still bent. Evaluated under the loads of a time step, which in a hit are ten times those that
/// hold the body where it is, the terms would also move the skin without the modes knowing: a
/// finger that bends an ear would set it trembling, more with each step. Here they are evaluated
/// under loads f' that follow those of the steps, f, and are fixed within a step:
///
///     tau df'/dt = f - f',      tau = (2 pi / omega_1) c / G
///
/// with omega_1 the lowest frequency, G the static compliance at the load's vertex (trace) and c
/// the part of the vibration modes in it: a dent is followed within some ms, the bending of a
/// whole ear in one period. At rest f' = f, and the terms are those of the static body.
///
/// In a step without time (Inertia::set_step(0)) changes of the loads are followed at once.
#pragma once

#include "palpable/common/response/compliance.h"
#include "palpable/common/response/inertia.h"
#include "palpable/common/response/nonlinear_response.h"

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// Allocates in its constructor.
class FollowedLoads {
 public:
  /// @param vertices       of the skin that the tables know
  /// @param most_vertices  of a step
  FollowedLoads(int vertices, int most_vertices);

  /// Gives a state what it needs to be advanced without allocations.
  void make_room(VibrationState& state) const { state.followed.reserve(followed_.capacity()); }

  /// A step begins: chooses the patches of load and evaluates the nonlinear terms.
  /// @param inertia  after its begin_step()
  /// @param cache    with the step's vertices
  /// @param loads    of the step's vertices when it begins
  /// @param weights  as many, of NonlinearResponse::choose_patches()
  /// @param regions  of the last frame's patches
  void begin_step(const Inertia& inertia, const ComplianceCache& cache, const VibrationState& state,
                  std::span<const VertexForce> loads, std::span<const float> weights,
                  std::span<const int> regions, NonlinearResponse& nonlinear);
  /// Evaluates the nonlinear terms under other loads, which a step without time needs.
  void evaluate(std::span<const VertexForce> loads, CrossTerms cross, NonlinearResponse& nonlinear);
  /// Another step begins, with the same vertices: the nonlinear terms stay as they were evaluated.
  /// @param inertia  with this step's time
  void go_on(const Inertia& inertia) { time_ = inertia.step(); }
  /// The step ends under these loads.
  void end_step(std::span<const VertexForce> loads, VibrationState& state);

  /// The state is static under these loads.
  static void rest(std::span<const VertexForce> loads, VibrationState& state);

 private:
  double time_ = 0;                     // s, of the step
  std::vector<FollowedLoad> followed_;  // of the step's vertices, then of others
  std::vector<VertexForce> begun_;      // the loads of the step's vertices when it began
  std::vector<VertexForce> evaluated_;
  std::vector<int> vertices_;  // those of followed_
  std::vector<float> weights_;
  std::vector<int> number_;  // by vertex: in followed_; -1: not among them
};

}  // namespace palpable
