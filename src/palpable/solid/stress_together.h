/// @file
/// Nodal stress of eight states of one body at a time: for those who need it of thousands.
///
///   N  nodes     n  nodes that are asked for
#pragma once

#include "palpable/solid/solid_model.h"
#include "palpable/solid/stress_recovery.h"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace palpable {

/// What nodal_cauchy_stress() gives at some nodes, for 4-node tetrahedra, eight states side by
/// side.
class StressTogether {
 public:
  static constexpr int kStates = 8;

  /// @param model  outlives this; 4-node tetrahedra
  /// @param nodes  (n) where stress is asked for
  StressTogether(const SolidModel& model, std::vector<int> nodes);

  /// (6n x 8) Pa, Cauchy, xx yy zz xy yz zx node by node; column by column a state.
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
