/// @file
/// The linear answer G f to loads at all nodes (compliance.h): far away by what arrives at each
/// cluster, near by from the rows of the loads' own vertices.
#pragma once

#include "palpable/common/response/compliance.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Holds the memory of its evaluations. Allocates in its constructor.
class LinearField {
 public:
  /// @param compliance  outlives this
  explicit LinearField(const Compliance& compliance);

  /// u = G f at the first n nodes, whatever the order of the loads. @param u  (3 x n) m
  void fill(std::span<const VertexForce> loads, const Eigen::Ref<Eigen::Matrix3Xf>& u);

 private:
  const Compliance& compliance_;
  std::vector<float> sources_, targets_;  // (C x k)
  std::vector<char> is_source_;           // (C)
  std::vector<VertexForce> by_cluster_;   // loads, ordered by their clusters
};

}  // namespace palpable
