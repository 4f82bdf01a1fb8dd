/// @file
/// The linear displacement G f under loads at any vertices (compliance.h): by sources and targets
/// between far clusters, by the rows of the loaded vertices in near ones.
#pragma once

#include "palpable/common/response/compliance.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Keeps the memory of its evaluations. Allocates in its constructor.
class LinearField {
 public:
  /// @param compliance  outlives this
  explicit LinearField(const Compliance& compliance);

  /// u = G f at the first n nodes. The result does not depend on the order of the loads. @param u
  /// (3 x n) m
  void fill(std::span<const VertexForce> loads, const Eigen::Ref<Eigen::Matrix3Xf>& u);

 private:
  const Compliance& compliance_;
  std::vector<float> sources_, targets_;  // (C x k)
  std::vector<char> is_source_;           // (C)
  std::vector<VertexForce> by_cluster_;   // loads that are not 0, ordered by their clusters
};

}  // namespace palpable
