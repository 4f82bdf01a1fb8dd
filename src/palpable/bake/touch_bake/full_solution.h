/// @file
/// The full-order displacement of a body under the contact forces of a live frame. The live run
/// adds its difference from the tables' displacement while the forces stay similar
/// (response/refinement.h).
///
///   N  nodes of the mesh     W  nodes of the shell
#pragma once

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/nonlinear_response.h"

#include <Eigen/Core>

#include <optional>
#include <span>

namespace palpable {

/// Relative residual at which the solution counts as found: a hundredth of the tables' error.
inline constexpr double kFullSolutionTolerance = 1e-4;

/// (3 x W) m, displacement of the shell's nodes under these forces from the state without contact.
/// Nothing if there is no load or the solver finds no equilibrium under it. A pure function of its
/// arguments.
/// @param solver     of the model that `skin` belongs to
/// @param preloaded  loads that act already, such as weight; nullptr: none
[[nodiscard]] std::optional<Eigen::Matrix3Xf> full_solution(const EquilibriumSolver& solver,
                                                            const SkinResponse& skin,
                                                            const Preloaded* preloaded,
                                                            std::span<const VertexForce> forces);

}  // namespace palpable
