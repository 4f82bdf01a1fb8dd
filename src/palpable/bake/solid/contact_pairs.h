/// @file
/// Augmented Lagrangian of unilateral contact: what each pair of a contact point and a part of the
/// obstacle contributes to energy, forces and tangent.
/// Internal to this module; contact.h is what others use.
///
///     g >= 0, p >= 0, g p = 0      g  gap of a point x to a part, m      p  its force, N
///
///     L(u, p) = Psi(u) + sum 1/(2 k) ( max(0, p - k g(u))^2 - p^2 ),    k  penalty, N/m
///
/// At a minimum over u the forces f = max(0, p - k g) are in equilibrium with the body. Updating
/// the multipliers, p <- f, then divides the errors of gaps and forces by about 1 + k * compliance
/// (Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991). After enough updates g f = 0 to
/// rounding, whatever k is.
///
/// Coulomb's friction, if there is any, adds a potential of each point that presses
/// (point_friction.h). Its anchor is a place of the obstacle, moves with it, and is kept from step
/// to step while the point presses:
///
///     a point begins to press    the anchor is the place of first contact, found by straight lines
///                                within the step
///     it sticks                  the anchor stays
///     it slips                   at the end of the step the anchor follows the point
///     it leaves                  the anchor is forgotten
///
/// The multipliers and normals in it are those of the previous update; repeated updates make them
/// the present ones. In its first minimisation a point that begins to press has no friction.
#pragma once

#include "palpable/bake/solid/block_matrix.h"
#include "palpable/bake/solid/contact_points.h"
#include "palpable/bake/solid/obstacle.h"
#include "palpable/bake/solid/point_friction.h"
#include "palpable/bake/solid/tet_assembly.h"

#include <Eigen/Core>

#include <optional>
#include <utility>
#include <vector>

namespace palpable {

/// One contact point against one part of the obstacle.
struct ContactPair {
  int point = 0, part = 0;
  double penalty = 0;     ///< N/m
  bool left_out = false;  ///< by leave_out_new()
  double multiplier = 0;  ///< N, >= 0
  Gap gap;                ///< at the last evaluation
  double force = 0;       ///< N, along the gap's normal, on the body
  /// With friction; its anchor is a point of the part, m, at the obstacle's pose of the last state,
  /// and during a step at that of the step's end.
  PointFriction friction = {};
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d whole_force() const { return force * gap.normal + friction.force; }
};

/// The pairs of a contact point and an obstacle that are near enough to touch within a step, with
/// their multipliers, and the sums of their forces and stiffnesses.
class ContactPairs {
 public:
  /// All arguments must outlive this object.
  /// @param penalties  (C) N/m of each point
  ContactPairs(const TetAssembly& assembly, const Boundary& boundary, const ContactPoints& points,
               const Eigen::VectorXd& penalties, const Friction& friction = {});

  [[nodiscard]] const std::vector<ContactPair>& pairs() const { return pairs_; }

  /// Between two steps: another coefficient of friction. Where there was none, points that press
  /// are held where they are. @param positions  of the last state
  void set_friction(double coefficient, const Eigen::Matrix3Xd& positions);

  /// Whether all nodes of a point are held. Such a point has no pairs.
  [[nodiscard]] bool is_held(const ContactPoint& point) const;
  /// m, how deep the obstacle is inside the points that are held; 0 if it is outside.
  [[nodiscard]] double held_entry(const ObstacleGaps& gaps,
                                  const Eigen::Matrix3Xd& positions) const;

  /// Adds all missing pairs that are nearer than `margin`, and drops pairs without multiplier that
  /// are farther than twice that. @returns the number of added pairs that touch (gap below 0)
  int find(const ObstacleGaps& gaps, const Eigen::Matrix3Xd& positions, double margin);

  /// Call this before each step if there is friction: moves the anchors with the obstacle.
  /// @param gaps    the obstacle at the end of the step; its parts are numbered as in pairs()
  /// @param before, positions_before  the obstacle and the nodes at the beginning of the step
  void begin_step(const ObstacleGaps& gaps, const Obstacle& before,
                  const Eigen::Matrix3Xd& positions_before);

  /// Between begin_step() and false: pairs that did not press before the step have no force.
  void leave_out_new(bool leave_out);

  /// With friction: where the nodes would be at the end of the step, if the points that begin to
  /// press in it did not. When and where these are touched follows from this.
  void set_predicted(const Eigen::Matrix3Xd& positions) { predicted_ = positions; }

  /// Computes gaps and forces at `positions`. @returns sum of 1/(2 k) (f^2 - p^2) and of D, J
  /// @param glued  pairs with a multiplier stay on the obstacle: their force f = p - k g may pull,
  ///               too
  double evaluate(const ObstacleGaps& gaps, const Eigen::Matrix3Xd& positions, bool glued = false);

  /// Adds the forces of the last evaluation to `force`, (3 x N) N at the nodes.
  void add_forces(Eigen::Matrix3Xd& force) const;

  /// y += tangent x, both (3M) in the free directions, after evaluate().
  /// @param with_curvature  include the obstacle's curvature: the result is then the exact
  ///                        derivative, which may be indefinite; without it, it is positive
  ///                        semidefinite
  void add_product(const Eigen::VectorXd& x, bool with_curvature, Eigen::VectorXd& y) const;

  /// K += tangent without the curvature.
  void add_tangent(BlockMatrix& K) const;

  /// With friction, before update_multipliers(): turns the planes of friction, and gives points
  /// that begin to press their anchors.
  /// @param positions  of the last evaluation
  /// @returns the largest value of update_cone(), m
  double update_friction(const ObstacleGaps& gaps, const Eigen::Matrix3Xd& positions);

  /// With friction, at the end of a step: moves the anchors of points that slipped, and forgets
  /// those of points that left. @returns the energy dissipated in the step, J
  double end_step(const Eigen::Matrix3Xd& positions);

  /// p <- f. @returns the largest |f - p| / k, m: how deep points are inside, or, for points
  /// outside, their remaining force over k
  double update_multipliers();

  /// Where the obstacle has other parts than `before`, at the last state, the numbers of its parts
  /// have a new meaning: a cup has appeared, a hand has left. Each pair with a multiplier is then
  /// assigned to the part that is nearest to its point now; all other pairs are dropped.
  void reassign_parts(const ObstacleGaps& gaps, const Obstacle& before,
                      const Eigen::Matrix3Xd& positions);

  /// The pairs, to be restored after a step that failed.
  void restore(std::vector<ContactPair> pairs) { pairs_ = std::move(pairs); }

 private:
  [[nodiscard]] bool has(int point, int part) const;
  [[nodiscard]] Eigen::Vector3d place_of_contact(const ObstacleGaps& gaps, const ContactPair& pair,
                                                 const Eigen::Vector3d& x) const;
  [[nodiscard]] Eigen::Matrix3d stiffness(const ContactPair& pair) const;

  const Boundary& boundary_;
  const ContactPoints& points_;
  const Eigen::VectorXd& penalties_;
  Friction friction_;
  std::vector<int> free_of_node_;
  std::vector<int> held_points_;
  Eigen::VectorXd mask_;            // (3M) 1, and 0 in held directions
  std::vector<ContactPair> pairs_;  // ordered by point, then part
  bool leaves_out_new_ = false;

  // With friction, of the present step: the obstacle and the nodes at its beginning, and
  // set_predicted().
  std::optional<ObstacleGaps> before_;
  Eigen::Matrix3Xd positions_before_, predicted_;
};

}  // namespace palpable
