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

/// The relative residual that is enough: a hundredth of what tables leave out.
inline constexpr double kFullSolutionTolerance = 1e-4;

/// (3 x W) m, how far the shell's nodes move under these forces from where nothing presses; nothing
/// where the body does not bear them. A pure function of its arguments.
/// @param solver     of the model that `skin` belongs to
/// @param preloaded  what acts already; nullptr: nothing
[[nodiscard]] std::optional<Eigen::Matrix3Xf> full_solution(const EquilibriumSolver& solver,
                                                            const SkinResponse& skin,
                                                            const Preloaded* preloaded,
                                                            std::span<const VertexForce> forces);

}  // namespace palpable
