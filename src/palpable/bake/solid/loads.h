/// @file
/// Consistent nodal forces of loads on the undeformed body: f_a = int N_a b dV + int N_a t dA.
///
///   N  nodes     K  nodes of a patch     T  triangles of the skin (skin_triangles(),
///   triangles_between())
///
/// All are dead loads: densities, areas and normals are those of the undeformed body, and a force
/// keeps its size and direction while the body moves (a gas pressure, by contrast, follows the
/// surface). Meshes of 4-node and of 10-node tetrahedra.
#pragma once

#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <functional>
#include <span>

namespace palpable {

/// Force in N per m^3 of undeformed volume, at the undeformed position X (m).
using BodyForceField = std::function<Eigen::Vector3d(const Eigen::Vector3d& X)>;
/// Force in N per m^2 of undeformed area, at the undeformed position X (m), with the outward unit
/// normal n.
using TractionField =
    std::function<Eigen::Vector3d(const Eigen::Vector3d& X, const Eigen::Vector3d& n)>;

/// (3 x N) N. Integrated by tetrahedron_rule().
[[nodiscard]] Eigen::Matrix3Xd body_force_load(const TetMesh& mesh, const BodyForceField& force);

/// (3 x N) N: weight.
/// @param density   kg/m^3, > 0
/// @param gravity   m/s^2, for instance (0, 0, -9.81)
/// @throws Error if the density is not above 0 or something is not finite
[[nodiscard]] Eigen::Matrix3Xd gravity_load(const TetMesh& mesh, double density,
                                            const Eigen::Vector3d& gravity);

/// (3 x N) N. Integrated by triangle_rule().
/// @param triangles  (3 x T) corner nodes, anticlockwise from outside
[[nodiscard]] Eigen::Matrix3Xd traction_load(const TetMesh& mesh, const Eigen::Matrix3Xi& triangles,
                                             const TractionField& traction);

/// (3 x N) N. @param pressure  Pa, > 0 pushes into the body
[[nodiscard]] Eigen::Matrix3Xd pressure_load(const TetMesh& mesh, const Eigen::Matrix3Xi& triangles,
                                             double pressure);

/// (3 x N) N of a traction that is linear over each triangle. Nodal forces of one mesh stand for
/// such a traction; with it they are carried over to another mesh of the same skin.
/// @param traction  (3 x N') Pa at the corner nodes, N' <= N their number
[[nodiscard]] Eigen::Matrix3Xd traction_load(const TetMesh& mesh, const Eigen::Matrix3Xi& triangles,
                                             const Eigen::Matrix3Xd& traction);

/// (3 x N) the load of one touch, a force spread over a patch of nodes: forces of 1 N in total
/// along `direction`, node k of the patch carrying its weight's share. With nodal areas as weights
/// the total does not depend on the mesh.
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
