/// @file
/// What all solves of one model share: element blocks, order of elimination, factor at rest.
/// Internal to this module; equilibrium.h is what others use.
#pragma once

#include "palpable/solid/equilibrium.h"
#include "palpable/solid/sparse_cholesky.h"
#include "palpable/solid/tet_assembly.h"

#include <vector>

namespace palpable {

/// The undeformed body's tangent, factorised; what every call starts with.
struct RestFactor {
  FactorPrecision precision = FactorPrecision::k16Bits;
  CholeskyFactor factor;
};

/// Read by all calls, written by none.
struct EquilibriumSolver::Core {
  SolidModel model;
  EquilibriumSettings settings;
  std::vector<HeldComponent> held;
  SolverSetup setup;
  FactorWorkspace workspace;  // of the construction only
  TetAssembly assembly;
  CholeskyAnalysis analysis;
  RestFactor at_rest;

  Core(SolidModel the_model, EquilibriumSettings the_settings);

  [[nodiscard]] bool moves_supports() const;

  /// What a load must be that alone sets the body in motion. @throws Error
  void check_load(const Eigen::Matrix3Xd& load) const;
};

}  // namespace palpable
