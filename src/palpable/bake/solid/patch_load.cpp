#include "palpable/bake/solid/patch_load.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <cmath>

namespace palpable {

Eigen::Matrix3Xd patch_force(int node_count, std::span<const int> nodes,
                             std::span<const double> weights, const Eigen::Vector3d& direction) {
  PALPABLE_EXPECT(nodes.size() == weights.size(), "one weight for each node of the patch");
  if (nodes.empty()) throw Error("the load's patch is empty; give it at least one node");
  const double length = direction.norm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw Error("the load's direction is zero or not finite; give a direction");
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k] < 0 || nodes[k] >= node_count) {
      throw Error(fmt::format("the load's patch has node {}, but the body has nodes 0 to {}",
                              nodes[k], node_count - 1));
    }
    if (!(weights[k] >= 0.0) || !std::isfinite(weights[k])) {
      throw Error(fmt::format("the load's weight at node {} is {}; weights are at least 0",
                              nodes[k], weights[k]));
    }
    sum += weights[k];
  }
  if (!(sum > 0.0)) {
    throw Error("the load's weights are all zero; use the nodes' areas, or 1 for each");
  }
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, node_count);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    force.col(nodes[k]) += weights[k] / (sum * length) * direction;
  }
  return force;
}

}  // namespace palpable
