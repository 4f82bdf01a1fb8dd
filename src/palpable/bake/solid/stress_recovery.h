/// @file
/// Recovers stress at the nodes from stress at the integration points.
///
///   N  nodes     E  tetrahedra     Q  integration points of each (1 or 4)
#pragma once

#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// **4-node elements** have one value each. A linear polynomial is fitted around each inner node to
/// the values of the elements that touch it (Zienkiewicz and Zhu's superconvergent patch recovery).
/// A node of the skin gets the mean of the polynomials of the nearest inner nodes at its position:
/// the elements around it lie to one side, so that their errors would not cancel. A field that is
/// linear in X is recovered exactly everywhere; a mean over elements is biased at the skin.
///
/// A patch grows, up to three elements wide, where its elements lie so that it would enlarge errors
/// (sum of |weights| above 5), or where no inner node is near. If that does not help, the node gets
/// the mean of the elements that touch it, weighted by volume. Patches ignore borders between
/// materials.
///
/// **10-node elements** have a linear field each, the one through the values at their four points.
/// A node gets the mean of the fields of the elements that touch it, weighted by volume. Linear
/// fields are recovered exactly here too. Patches were worse: on coarse bodies the von Mises stress
/// of a pressed ball with ears was off by 23-30 % with them and by 14-18 % without.
///
/// Everything that depends on the mesh alone is computed once; several threads may call apply() at
/// the same time.
class StressRecovery {
 public:
  /// @param mesh  4-node or 10-node tetrahedra; it need not outlive this object
  explicit StressRecovery(const TetMesh& mesh);

  /// (R x N) from (R x Q E), columns as point_cauchy_stress() has them; R = 6.
  [[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> apply(
      const Eigen::Matrix<double, 6, Eigen::Dynamic>& at_points) const;

  /// (R x n) the same at some nodes, for R values a point of any kind.
  [[nodiscard]] Eigen::MatrixXd apply_at(const std::vector<int>& nodes,
                                         const Eigen::MatrixXd& at_points) const;

  /// One term of a node's value: weight * value at the point.
  struct Term {
    int point;
    double weight;
  };
  /// The terms whose sum is the value at a node.
  [[nodiscard]] std::span<const Term> terms_of(int node) const {
    const auto n = static_cast<std::size_t>(node);
    return {terms_.data() + start_[n], terms_.data() + start_[n + 1]};
  }

  /// Nodes of 4-node elements that got the mean because no patch served.
  [[nodiscard]] int averaged_nodes() const { return averaged_nodes_; }

 private:
  void recover_from_patches(const TetMesh& mesh);
  void recover_from_elements(const TetMesh& mesh);

  std::vector<int> start_;  // (N + 1) into terms_
  std::vector<Term> terms_;
  Eigen::Index points_ = 0;
  int averaged_nodes_ = 0;
};

}  // namespace palpable
