/// @file
/// Stress at the nodes from stress in the elements.
///
///   N  nodes     E  tetrahedra     Q  integration points of each (1 or 4)
#pragma once

#include "palpable/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// 4-node elements have one value each: around each inner node a linear polynomial is fitted to the
/// values of the elements that touch it (Zienkiewicz and Zhu's superconvergent patch recovery). A
/// node of the skin takes the mean of what the polynomials of the nearest inner nodes say at its
/// place, because in its own one-sided patch the elements' errors would not cancel. A field that is
/// linear in X comes out exactly everywhere, where averaging the elements leans to the inside.
///
/// Where the elements lie so unluckily that errors would be enlarged (sum of |weights| above 5), or
/// where no inner node is near, patches grow up to three elements wide; if even that does not help,
/// the mean of the touching elements by volume is taken. Patches do not stop at the border between
/// two materials.
///
/// 10-node elements have a linear field each: the one through the values at their four points, and
/// a node takes the mean, by volume, of what the elements that touch it say there. A linear field
/// comes out exactly here too, and no detail is lost to a patch: on coarse bodies the patches'
/// error was half as large again (von Mises stress of a pressed ball with ears, 23-30 % against
/// 14-18 %).
///
/// All that depends on the mesh is computed once; apply() is const and may run in several threads.
class StressRecovery {
 public:
  explicit StressRecovery(const TetMesh& mesh);

  /// (R x N) from (R x Q E), columns as point_cauchy_stress() has them; R = 6.
  [[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> apply(
      const Eigen::Matrix<double, 6, Eigen::Dynamic>& at_points) const;

  /// (R x n) the same at some nodes, for any R values a point.
  [[nodiscard]] Eigen::MatrixXd apply_at(const std::vector<int>& nodes,
                                         const Eigen::MatrixXd& at_points) const;

  /// Nodes of 4-node elements that had to take the mean.
  [[nodiscard]] int averaged_nodes() const { return averaged_nodes_; }

 private:
  void recover_from_patches(const TetMesh& mesh);
  void recover_from_elements(const TetMesh& mesh);

  struct Term {
    int point;
    double weight;
  };
  std::vector<int> start_;   // (N + 1) into terms_
  std::vector<Term> terms_;  // value at node n: sum over its terms of weight * value at point
  Eigen::Index points_ = 0;
  int averaged_nodes_ = 0;
};

}  // namespace palpable
