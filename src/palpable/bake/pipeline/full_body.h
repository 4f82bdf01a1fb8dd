/// @file
/// A full-order body at rest: its supports and its preload have acted, and nothing presses it yet.
#pragma once

#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/touch_bake/skin_response.h"

#include <Eigen/Core>

namespace palpable {

/// The full-order solver of a body and the response of its skin. Not copyable, because its parts
/// refer to each other.
struct FullBody {
  EquilibriumSolver solver;
  PressSolver presses;
  SkinResponse skin;

  /// @param preload  (3 x N) N, or no columns for none
  /// @throws Error when the body has no equilibrium under the preload
  FullBody(const SolidModel& model, const Boundary& boundary, const Eigen::Matrix3Xd& preload,
           const EquilibriumSettings& settings = {})
      : solver(model, settings),
        presses(solver, preload),
        skin(model, boundary, presses.preloaded()) {}
  FullBody(const FullBody&) = delete;
  FullBody& operator=(const FullBody&) = delete;
};

}  // namespace palpable
