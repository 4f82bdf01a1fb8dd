/// @file
/// Contact points: the points of a body's skin at which obstacles are kept out of it.
///
///   N  nodes     C  contact points
///
/// With contact at the corners alone, a pencil's tip, which is smaller than a triangle, would pass
/// between them. Therefore the points form a grid over every triangle of the skin: its corners,
/// points along its edges, and points inside it, none farther than `spacing` from the next along an
/// edge.
///
/// Between the points an obstacle of radius r penetrates by spacing^2 / (8 r) at most where the
/// skin is flat, and by the slope times spacing / 2 at a fold. ContactState::entry_between is the
/// measured value of each state.
#pragma once

#include "palpable/bake/solid/block_matrix.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace palpable {

/// A point of the skin: a mean of nodes with fixed weights.
struct ContactPoint {
  std::array<int, 6> nodes{};     ///< of the mesh; the first `count` are used
  std::array<double, 6> shape{};  ///< their shape functions at the point, sum 1
  int count = 0;
  int triangle = -1;  ///< of the skin; one of those that share the point
  double area = 0;    ///< m^2, its share of the skin
};

struct ContactPoints {
  std::vector<ContactPoint> points;  ///< (C)
  /// The points of triangle t, including those on its edges and corners, are
  /// of_triangle[first[t]] .. of_triangle[first[t + 1] - 1].
  std::vector<int> first, of_triangle;
};

/// @param boundary  boundary_of(mesh); of a mesh with 10-node tetrahedra the points lie on its
///                  curved faces
/// @param spacing   m, > 0
[[nodiscard]] ContactPoints contact_points(const TetMesh& mesh, const Boundary& boundary,
                                           double spacing);

/// m, the distance between contact points: `wanted` if that is above 0, otherwise half the smallest
/// radius (m) of the obstacle, but no more than a third of the skin's mean edge.
/// @throws Error where it asks for more points than memory holds
[[nodiscard]] double contact_spacing(double wanted, const SurfaceMesh& skin, double radius);

/// (N) N/m, the mean diagonal of a stiffness at each node: what penalties of contact are measured
/// by. Held nodes, which do not move whatever the penalty, get the mean of the others.
/// @param free_nodes  the node of each row of K
[[nodiscard]] Eigen::VectorXd node_stiffnesses(const BlockMatrix& K,
                                               const std::vector<int>& free_nodes, int nodes);

/// (C) mean of a nodal value over the nodes of each point, weighted by |shape|. @param of_nodes (N)
[[nodiscard]] Eigen::VectorXd means_at_points(const ContactPoints& points,
                                              const Eigen::VectorXd& of_nodes);

/// Position of the point, m. @param positions  (3 x N) of the deformed nodes, m
[[nodiscard]] Eigen::Vector3d position_of(const ContactPoint& point,
                                          const Eigen::Matrix3Xd& positions);

}  // namespace palpable
