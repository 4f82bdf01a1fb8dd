/// @file
/// Nodal stress of eight states of one body at a time, for callers that need thousands of states.
///
///   N  nodes     n  nodes at which stress is wanted
#pragma once

#include "palpable/bake/solid/solid_model.h"
#include "palpable/bake/solid/stress_recovery.h"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace palpable {

/// nodal_cauchy_stress() at some nodes of a mesh of 4-node tetrahedra, eight states side by side.
class StressTogether {
 public:
  static constexpr int kStates = 8;  ///< states side by side

  /// @param model  4-node tetrahedra; must outlive this object
  /// @param nodes  (n) where stress is wanted
  StressTogether(const SolidModel& model, std::vector<int> nodes);

  /// (6n x 8) Cauchy stress, Pa, xx yy zz xy yz zx node by node. Column s belongs to state s.
  /// @param u  (3N x 8) m
  /// @throws Error if an element is inverted (J <= 0) under one of them
  [[nodiscard]] Eigen::MatrixXd operator()(const Eigen::MatrixXd& u) const;

 private:
  const SolidModel& model_;
  std::vector<int> nodes_;
  StressRecovery recovery_;
  std::vector<int> group_of_;
};

}  // namespace palpable
