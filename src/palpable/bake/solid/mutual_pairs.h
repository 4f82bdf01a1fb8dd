/// @file
/// Contact between the components of one mesh: the contact points on the skin of each component
/// against the triangles of the others' skins, on both sides, by the augmented Lagrangian of
/// contact_pairs.h. Internal to this module; contact.h is what others use.
///
///     x = sum N_a x_a      a contact point
///     y = sum w_b x_b      the nearest point of the other skin
///     g = n . (x - y)      f = max(0, p - k g)
///
/// The force is N_a f n at x's nodes and -w_b f n at y's. Both sums of weights are 1: the forces on
/// the two bodies are opposite to rounding, and so are their moments once x is at y.
///
///            x  o   component A: its skin faces down
///               |  g
///        -------+------- y, normal n
///                  component B: its triangle faces up
///
/// detect() determines y (triangle and weights w) and n between the updates of the multipliers;
/// they stay fixed while the Lagrangian is minimised. Therefore g is linear in the displacement, L
/// has no kinks, and its second derivative k (dg/du)(dg/du)^T is exact. The rotation of n and the
/// motion of y along the other skin are not in the tangent; the next detect() accounts for them.
/// The updates end when a further detect() changes neither.
///
/// n is the mean normal of the triangles that meet at each corner of y's triangle, interpolated to
/// y. The faces of a curved skin differ by a few degrees; if the force jumped by that angle
/// whenever y crosses an edge, the updates would not converge. Triangles that meet at more than 30
/// degrees in the undeformed body are not averaged, so that edges of a box stay sharp.
///
/// Friction is that of contact_pairs.h. The anchor of a point is a point of the other skin, that is
/// of one of its triangles:
///
///     a = sum v_c x_c        s = P (x - a)        friction on x's nodes + N_a t, on a's - v_c t
///
/// Both sums of weights are 1, so the two bodies again have opposite forces; and opposite moments,
/// because s is parallel to t. A triangle's weights v may be negative where the point slid
/// beyond its rim within a step.
#pragma once

#include "palpable/bake/solid/block_matrix.h"
#include "palpable/bake/solid/contact_points.h"
#include "palpable/bake/solid/point_friction.h"
#include "palpable/bake/solid/tet_assembly.h"

#include <Eigen/Core>

#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace palpable {

/// One contact point against one other component.
struct MutualPair {
  int point = 0;
  int owner = 0, component = 0;  ///< components of the point and of the triangle
  /// Whether the triangle faces the skin at the point. If not, it is the nearest triangle, and the
  /// point lies inside the component: two edges cross.
  bool faces = true;
  std::array<int, 6> nodes{};     ///< of the mesh: first x's, then y's
  std::array<double, 6> shape{};  ///< N_a > 0 of x, then -w_b of y: they sum to 0
  int count = 0, own_count = 0;   ///< number of all nodes, and of x's
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, outwards
  double penalty = 0;                                 ///< N/m
  double multiplier = 0;                              ///< N, >= 0
  double gap = 0;                                     ///< m, at the last evaluation
  double force = 0;                                   ///< N
  int triangle = -1;                                  ///< y's, of the skin
  /// With friction; the anchor is on the triangle with these corners.
  PointFriction friction = {};
  std::array<int, 3> anchor_nodes{};     ///< of the mesh
  std::array<double, 3> anchor_shape{};  ///< v_c, sum 1
};

/// The pairs that are near enough to matter, and their sums.
class MutualPairs {
 public:
  /// @param boundary, points  must outlive this object
  /// @param penalties  (N) N/m of each node; a pair combines those of both sides in series
  /// @param edge  m, mean edge of the skin: points that are farther from a skin form no pair with
  ///              it
  /// @throws Error for 10-node tetrahedra: their skins are curved, and y would not lie on them
  MutualPairs(const TetAssembly& assembly, const TetMesh& mesh, const Boundary& boundary,
              const ContactPoints& points, Eigen::VectorXd penalties, double edge,
              const Friction& friction = {});

  [[nodiscard]] int component_count() const { return static_cast<int>(bodies_.size()); }
  [[nodiscard]] const std::vector<MutualPair>& pairs() const { return pairs_; }

  /// The pairs at some positions, and how far they are from pairs().
  struct Detection {
    std::vector<MutualPair> pairs;  ///< multipliers and forces are those of pairs()
    double smallest_gap = std::numeric_limits<double>::infinity();  ///< m, of all pairs
    /// How far the pairs with force have moved since pairs(): root mean square, weighted by the
    /// squares of the forces, of the changes of their normals (rad) and of y (ratio to `edge`). A
    /// pair that no longer exists counts as 1.
    double shift = 0;
    /// Number of points deeper inside another component than a third of the smallest side of its
    /// box. Nothing pushes them out, because the direction outwards is no longer certain.
    int buried = 0;
  };
  [[nodiscard]] Detection detect(const Eigen::Matrix3Xd& positions) const;
  /// Replaces pairs() by those that were detected.
  void use(Detection&& detected) { pairs_ = std::move(detected.pairs); }

  /// As ContactPairs::begin_step(), set_predicted(), update_friction() and end_step().
  void begin_step(const Eigen::Matrix3Xd& positions_before);
  void set_predicted(const Eigen::Matrix3Xd& positions) { predicted_ = positions; }
  double update_friction(const Eigen::Matrix3Xd& positions);
  double end_step(const Eigen::Matrix3Xd& positions);

  /// Computes gaps and forces at `positions`. @returns sum of 1/(2 k) (f^2 - p^2) and of the
  /// friction's potential, J
  /// @param glued  pairs with a multiplier stay in contact: their force f = p - k g may pull, too
  double evaluate(const Eigen::Matrix3Xd& positions, bool glued = false);

  /// Adds the forces of the last evaluation to `force`, (3 x N) N at the nodes.
  void add_forces(Eigen::Matrix3Xd& force) const;

  /// y += tangent x, both (3M) in the free directions, after evaluate().
  void add_product(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  /// K += tangent. If K's pattern lacks a block between the two components of a pair, only the
  /// pair's blocks within each component are added, which keeps K positive definite.
  void add_tangent(BlockMatrix& K) const;
  /// Whether the pattern has all blocks between components that pairs with force need.
  [[nodiscard]] bool fits(const BlockPattern& pattern) const;
  /// The pattern with those blocks added.
  [[nodiscard]] BlockPattern widened(const BlockPattern& pattern) const;

  /// p <- f. @returns the largest |f - p| / k, m
  double update_multipliers();

  /// (3 x components) N, the force of the others on each component, by the last evaluation.
  [[nodiscard]] Eigen::Matrix3Xd force_on_components() const;

  /// Restores pairs() after a step that failed.
  void restore(std::vector<MutualPair> pairs) { pairs_ = std::move(pairs); }

 private:
  struct Body {                  // a component
    std::vector<int> vertices;   // of the skin
    std::vector<int> triangles;  // of the skin
    std::vector<int> points;
    double deepest = 0;  // m: points that are farther inside form no pair
  };
  class Moved;
  // The nodes between which a force acts, and their weights: first x's, then those of y or a.
  struct Stencil {
    std::array<int, 6> nodes{};
    std::array<double, 6> shape{};
    int count = 0, own_count = 0;
  };
  static Stencil stencil_of(const MutualPair& pair);
  static Stencil stencil_of_friction(const MutualPair& pair);
  template <class Add>
  void visit_blocks(const BlockPattern& pattern, const Stencil& stencil, const Add& add) const;
  void add_friction_product(const MutualPair& pair, const Eigen::VectorXd& x,
                            Eigen::VectorXd& y) const;
  void set_anchor(const Eigen::Matrix3Xd& positions, const Eigen::Vector3d& at,
                  MutualPair& pair) const;
  [[nodiscard]] Eigen::Vector3d place_of_contact(const Eigen::Matrix3Xd& positions,
                                                 const MutualPair& pair) const;
  // Calls visit(row, column) for the blocks between components that a pair's forces need.
  template <class Visit>
  void visit_blocks_between(const MutualPair& pair, const Visit& visit) const;
  void add_pair(const Moved& skin, int component, int point, Detection& detected) const;
  [[nodiscard]] const MutualPair* pair_of(int point, int component) const;
  void find_smooth_neighbours();
  void find_faces_of_points();

  const Boundary& boundary_;
  const ContactPoints& points_;
  Eigen::VectorXd penalties_;
  double edge_;
  Friction friction_;
  std::vector<Body> bodies_;
  // The normal at corner k of triangle t is the mean of those of the triangles
  // smooth_[first_smooth_[3 t + k]] .. smooth_[first_smooth_[3 t + k + 1] - 1].
  std::vector<int> first_smooth_, smooth_;
  std::vector<int> first_face_, faces_;  // triangles that share a contact point, likewise
  std::vector<int> free_of_node_;
  Eigen::VectorXd mask_;           // (3M) 1, and 0 in held directions
  std::vector<MutualPair> pairs_;  // ordered by point, then component
  // With friction, of the present step: the nodes at its beginning, and set_predicted().
  Eigen::Matrix3Xd positions_before_, predicted_;
};

}  // namespace palpable
