/// @file
/// A body as things find it that press it: its supports and its preload have acted.
#pragma once

#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/touch_bake/skin_response.h"

#include <Eigen/Core>

namespace palpable {

/// The full solver of a body, and what its skin does. Stays where it is: its parts refer to each
/// other.
struct FullBody {
  EquilibriumSolver solver;
  PressSolver presses;
  SkinResponse skin;

  /// @param preload  (3 x N) N, or no columns for none
  /// @throws Error when the body cannot bear the preload
  FullBody(const SolidModel& model, const Boundary& boundary, const Eigen::Matrix3Xd& preload,
           const EquilibriumSettings& settings = {})
      : solver(model, settings),
        presses(solver, preload),
        skin(model, boundary, presses.preloaded()) {}
  FullBody(const FullBody&) = delete;
  FullBody& operator=(const FullBody&) = delete;
};

}  // namespace palpable
