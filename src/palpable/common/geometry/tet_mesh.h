/// @file
/// Tetrahedral meshes of volumes.
///
///   N  nodes     E  tetrahedra
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The edges of a tetrahedron by its corners, in the order of edge_nodes (that of Abaqus' and
/// CalculiX' C3D10 and of VTK's quadratic tetrahedron).
inline constexpr int kTetEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

/// Nodes and tetrahedra of 4 or, all of them, 10 nodes; (x1 - x0) x (x2 - x0) . (x3 - x0) > 0 in a
/// mesh that is not inverted.
struct TetMesh {
  Eigen::Matrix3Xd nodes;  ///< (3 x N) m
  Eigen::Matrix4Xi tets;   ///< (4 x E) node indices of the corners
  /// (6 x E) node indices of the edges' middles, kTetEdges; no columns: 4-node tetrahedra.
  Eigen::Matrix<int, 6, Eigen::Dynamic> edge_nodes = {};

  [[nodiscard]] int node_count() const { return static_cast<int>(nodes.cols()); }
  [[nodiscard]] int tet_count() const { return static_cast<int>(tets.cols()); }
  [[nodiscard]] bool is_quadratic() const { return edge_nodes.cols() > 0; }
};

/// The same body with 10-node tetrahedra: a node in the middle of each edge, numbered after those
/// of `mesh`, which keep their numbers. @pre `mesh` has 4-node tetrahedra
[[nodiscard]] TetMesh with_edge_nodes(const TetMesh& mesh);

/// The same nodes with 4-node tetrahedra, eight for each of `mesh`: one at each corner, and the
/// octahedron in the middle cut along the shortest of its three diagonals, which keeps the pieces
/// well shaped. Those of tetrahedron e are 8 e .. 8 e + 7.
/// @pre `mesh` has 10-node tetrahedra
[[nodiscard]] TetMesh split_into_eight(const TetMesh& mesh);

/// (E) signed volumes between the corners, m^3.
[[nodiscard]] Eigen::VectorXd tet_volumes(const TetMesh& mesh);

/// (N) the lumped mass of density 1, m^3. A 4-node tetrahedron gives each node a quarter of its
/// volume; a 10-node one gives 1/36 to each corner and 4/27 to each edge node (in proportion to the
/// diagonal of the consistent mass; its row sums are negative at the corners).
[[nodiscard]] Eigen::VectorXd nodal_volumes(const TetMesh& mesh);

/// (N) the component that each node belongs to: parts of the mesh that share no node, numbered in
/// the order of their first node. Nodes of no tetrahedron: -1.
[[nodiscard]] std::vector<int> node_components(const TetMesh& mesh);

/// The skin of a volume; its vertices are numbered anew, and their nodes are stored.
struct Boundary {
  SurfaceMesh surface;              ///< oriented outwards
  std::vector<int> node_of_vertex;  ///< surface vertex -> node of the volume mesh, increasing
};

/// The skin: the faces that belong to only one tetrahedron, by their corners.
[[nodiscard]] Boundary boundary_of(const TetMesh& mesh);

/// A box of nx x ny x nz cells, each cut into six tetrahedra (Kuhn); conforming. For tests,
/// examples and the beam.
[[nodiscard]] TetMesh box_tets(const Eigen::Vector3d& a, const Eigen::Vector3d& b, int nx, int ny,
                               int nz);

}  // namespace palpable
