/// @file
/// What all solves of one model share: element blocks, order of elimination, factor at rest.
/// Internal to this module; equilibrium.h is what others use.
#pragma once

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/sparse_cholesky.h"
#include "palpable/bake/solid/tet_assembly.h"

#include <vector>

namespace palpable {

/// The factor of the undeformed body's tangent; every call starts with it.
struct RestFactor {
  FactorPrecision precision = FactorPrecision::k16Bits;
  CholeskyFactor factor;
};

/// Constant after its construction; calls only read it.
struct EquilibriumSolver::Core {
  SolidModel model;
  EquilibriumSettings settings;
  std::vector<HeldComponent> held;
  SolverSetup setup;
  FactorWorkspace workspace;  // used by the constructor only
  TetAssembly assembly;
  CholeskyAnalysis analysis;
  RestFactor at_rest;

  Core(SolidModel the_model, EquilibriumSettings the_settings);

  [[nodiscard]] bool moves_supports() const;

  /// @throws Error if the load is not finite, acts on held nodes only, or is zero and no support
  /// moves
  void check_load(const Eigen::Matrix3Xd& load) const;
};

}  // namespace palpable
