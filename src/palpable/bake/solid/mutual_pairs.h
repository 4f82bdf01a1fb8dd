/// @file
/// Contact between the bodies of one mesh, its components: contact points of the skin of each
/// against the triangles of the others' skins, on both sides, by the augmented Lagrangian of
/// contact_pairs.h. Without friction.
/// Internal to this module; contact.h is what others use.
///
///     x = sum N_a x_a      a contact point            y = sum w_b x_b      the nearest point of
///     the
///                                                                          other skin
///     g = n . (x - y)      f = max(0, p - k g)        + N_a f n at x's nodes,  - w_b f n at y's
///
/// Both sums of weights are 1: the forces on the two bodies are opposite to rounding, and so are
/// their moments once x is at y.
///
///            x  o   component A: its skin faces down
///               |  g
///        -------+------- y, normal n
///                  component B: its triangle faces up
///
/// Where y lies (triangle and weights w) and which way n points is settled by look(), between the
/// updates of the multipliers, and stays while the Lagrangian is minimised. So g is linear in the
/// displacement there, L has no kinks, and its second derivative k (dg/du)(dg/du)^T is exact: how n
/// turns and y moves on is not in the tangent but in the next look(). The updates end when a
/// further look() changes neither.
///
/// n is the mean normal of the triangles that meet at each corner of y's triangle, interpolated to
/// y: faces of a bent skin differ by a few degrees, and a force that jumps by them whenever y
/// crosses an edge would not settle. Triangles that meet by more than 30 degrees in the undeformed
/// body are not averaged, so edges of a box stay sharp.
#pragma once

#include "palpable/bake/solid/block_matrix.h"
#include "palpable/bake/solid/contact_points.h"
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
  int owner = 0, component = 0;  ///< of the point; of the triangle
  /// Whether the triangle faces the point's own skin; else it is the nearest one, and the point
  /// inside: two edges that cross.
  bool faces = true;
  std::array<int, 6> nodes{};     ///< of the mesh; the first `count`: x's, then y's
  std::array<double, 6> shape{};  ///< N_a > 0 of x, then -w_b of y: they sum to 0
  int count = 0, own_count = 0;   ///< all, and x's
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, out of the component
  double penalty = 0;                                 ///< N/m
  double multiplier = 0;                              ///< N, >= 0
  double gap = 0;                                     ///< m, at the last evaluation
  double force = 0;                                   ///< N
};

/// The pairs that are near enough to matter, and their sums.
class MutualPairs {
 public:
  /// @param boundary, points  outlive this
  /// @param penalties  (N) N/m of each node; a pair takes both sides' in series
  /// @param edge  m, mean edge of the skin: what is farther than that is no pair
  /// @throws Error for 10-node tetrahedra: their skins are curved, and y would not lie on them
  MutualPairs(const TetAssembly& assembly, const TetMesh& mesh, const Boundary& boundary,
              const ContactPoints& points, Eigen::VectorXd penalties, double edge);

  [[nodiscard]] int component_count() const { return static_cast<int>(bodies_.size()); }
  [[nodiscard]] const std::vector<MutualPair>& pairs() const { return pairs_; }

  /// The pairs as they lie at some positions.
  struct Look {
    std::vector<MutualPair> pairs;  ///< multipliers and forces are those of before
    double smallest_gap = std::numeric_limits<double>::infinity();  ///< m, of all pairs
    /// Relative to all forces: by how much directions (rad) and places (of a mean edge) of those
    /// that press differ from what they were before; a pair that is no more counts as 1.
    double shift = 0;
    /// Points deeper inside another component than a third of the smallest side of its box. Nothing
    /// pushes them out: which way is out is no longer sure.
    int buried = 0;
  };
  [[nodiscard]] Look look(const Eigen::Matrix3Xd& positions) const;
  void take(Look&& look) { pairs_ = std::move(look.pairs); }

  /// Gaps and forces at `positions`. @returns sum of 1/(2 k) (f^2 - p^2), J
  /// @param glued  points that were pressed stay: f = p - k g may pull, too
  double evaluate(const Eigen::Matrix3Xd& positions, bool glued = false);

  /// Adds the forces of the last evaluation to those of the nodes, (3 x N) N.
  void add_forces(Eigen::Matrix3Xd& force) const;

  /// y += tangent x, both (3M) in the free directions, after evaluate().
  void add_product(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  /// K += tangent. Of a pair whose blocks between the two components are not all in K's pattern,
  /// only those within each of them, which keeps K positive definite.
  void add_tangent(BlockMatrix& K) const;
  /// Whether the pattern has all blocks of the pairs with force.
  [[nodiscard]] bool fits(const BlockPattern& pattern) const;
  /// A pattern with those blocks, too.
  [[nodiscard]] BlockPattern widened(const BlockPattern& pattern) const;

  /// p <- f. @returns the largest |f - p| / k, m
  double update_multipliers();

  /// (3 x components) N on each by the others, of the last evaluation.
  [[nodiscard]] Eigen::Matrix3Xd force_on_components() const;

  /// To put pairs() back as they were, after a step that failed.
  void restore(std::vector<MutualPair> pairs) { pairs_ = std::move(pairs); }

 private:
  struct Body {                  // a component
    std::vector<int> vertices;   // of the skin
    std::vector<int> triangles;  // of the skin
    std::vector<int> points;
    double deepest = 0;  // m: points that are farther inside are not near
  };
  class Moved;
  void place_on(const Moved& skin, int component, int point, Look& look) const;
  [[nodiscard]] const MutualPair* pair_of(int point, int component) const;
  void find_smooth_neighbours();
  void find_faces_of_points();

  const Boundary& boundary_;
  const ContactPoints& points_;
  Eigen::VectorXd penalties_;
  double edge_;
  std::vector<Body> bodies_;
  std::vector<int> first_smooth_, smooth_;  // corner k of triangle t: the triangles whose mean
                                            // normal it has, at first_smooth_[3 t + k] ..
  std::vector<int> first_face_, faces_;     // triangles that share a contact point
  std::vector<int> free_of_node_;
  Eigen::VectorXd mask_;           // (3M) 1, and 0 in held directions
  std::vector<MutualPair> pairs_;  // ordered by point, then component
};

}  // namespace palpable
