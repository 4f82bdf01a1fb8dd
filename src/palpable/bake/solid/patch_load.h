/// @file
/// The load of one touch: a force spread over a patch of nodes.
///
///   N  nodes of the body     K  nodes of the patch
#pragma once

#include <Eigen/Core>

#include <span>

namespace palpable {

/// (3 x N) forces of 1 N in total along `direction`, node k of the patch carrying its weight's
/// share. With nodal areas as weights the total does not depend on the mesh.
///
/// Dead load: it keeps its direction while the body moves.
/// @param nodes      (K) node indices
/// @param weights    (K) >= 0, not all zero; their scale does not matter
/// @param direction  not zero; its length does not matter
/// @throws Error for an empty patch, a node out of range, weights or a direction that are all zero
[[nodiscard]] Eigen::Matrix3Xd patch_force(int node_count, std::span<const int> nodes,
                                           std::span<const double> weights,
                                           const Eigen::Vector3d& direction);

}  // namespace palpable
