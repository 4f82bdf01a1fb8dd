/// @file
/// Tetrahedral volumes.
///
///   N  nodes     E  tetrahedra
#pragma once

#include "palpable/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Nodes and 4-node tetrahedra; (x1 - x0) x (x2 - x0) . (x3 - x0) > 0 in a mesh that is not
/// inverted.
struct TetMesh {
  Eigen::Matrix3Xd nodes;  ///< (3 x N) m
  Eigen::Matrix4Xi tets;   ///< (4 x E) node indices

  [[nodiscard]] int node_count() const { return static_cast<int>(nodes.cols()); }
  [[nodiscard]] int tet_count() const { return static_cast<int>(tets.cols()); }
};

/// (E) signed volumes, m^3.
[[nodiscard]] Eigen::VectorXd tet_volumes(const TetMesh& mesh);

/// (N) a quarter of the volume of the adjacent tetrahedra, m^3: the lumped mass of density 1.
[[nodiscard]] Eigen::VectorXd nodal_volumes(const TetMesh& mesh);

/// The skin of a volume, with vertices numbered anew and the way back.
struct Boundary {
  SurfaceMesh surface;              ///< oriented outwards
  std::vector<int> node_of_vertex;  ///< surface vertex -> node of the volume mesh, increasing
};

/// Faces that belong to one tetrahedron only.
[[nodiscard]] Boundary boundary_of(const TetMesh& mesh);

/// A box of nx x ny x nz cells, each cut into six tetrahedra (Kuhn); conforming. For tests,
/// examples and the beam.
[[nodiscard]] TetMesh box_tets(const Eigen::Vector3d& a, const Eigen::Vector3d& b, int nx, int ny,
                               int nz);

}  // namespace palpable
