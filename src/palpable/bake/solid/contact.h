/// @file
/// The full-order solution of a hyperelastic body that rigid obstacles press: unilateral contact at
/// the contact points of its skin (contact_points.h) by an augmented Lagrangian (contact_pairs.h).
/// Friction is off unless ContactSettings::friction asks for it; its law is in point_friction.h.
///
///     internal_force(u) = preload + sum f_i n_i N(x_i)        at the free nodes
///     g_i(u) >= 0,   f_i >= 0,   g_i f_i = 0                  at every contact point
///
/// Points whose nodes are all held are none of these: no force would move them out of an obstacle,
/// which passes through them (ContactState::held_entry). Where nodes are held only along the
/// obstacle's normal, as on rollers, no solution is found.
///
///   N  nodes      u  displacement, (3 x N) m      t  time of the obstacle's motion
///
/// With ContactSettings::mutual the components of a mesh, which share no node (joined_model.h),
/// press each other, too: the contact points of each component are tested against the triangles of
/// the others. All components deform and are solved together (mutual_pairs.h).
///
/// Each state is found by Newton's method with a line search on the Lagrangian. Conjugate gradients
/// solve for its steps. Their preconditioner is the factor of the tangent at rest, and, once that
/// takes too many iterations, the factor of a tangent with the stiffness of the contact in it.
#pragma once

#include "palpable/bake/solid/contact_points.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/obstacle.h"

#include <Eigen/Core>

#include <limits>
#include <memory>
#include <string>

namespace palpable {

struct ContactSettings {
  /// Largest residual at the free nodes, ratio to the norm of contact forces, preload and forces at
  /// the held nodes together.
  double tolerance = 1e-7;
  /// Largest penetration of a contact point, ratio to the body's size (the diagonal of its bounding
  /// box); five times as much with friction between components.
  double largest_entry = 1e-6;
  /// Distance between contact points, m. 0: half the smallest radius of the obstacle, but no more
  /// than a third of the skin's mean edge. A tip that is smaller than the spacing passes between
  /// the points.
  double spacing = 0;
  /// Penalty stiffness of a contact point, ratio to the stiffness of its nodes. A larger one needs
  /// fewer updates of the multipliers, but gives linear systems of worse condition: where a step
  /// pushes a slender body by much more than its element size, 5 is several times as fast as 200.
  double penalty = 200;
  /// Coulomb's coefficient of friction between obstacle and skin; 0: none. With friction the
  /// solution depends on the obstacle's path: within a step points and obstacle move in straight
  /// lines, and a point that slips slides in one direction. What friction holds is kept from state
  /// to state (contact_pairs.h): an obstacle at rest holds the skin, however many steps it rests.
  double friction = 0;
  /// Stiffness with which friction holds a point, ratio as for `penalty`. A point that sticks gives
  /// way by its friction force over this, the elastic slip (point_friction.h). With a large one
  /// points may change between sticking and slipping from update to update.
  double sticking_penalty = 30;
  /// Whether the separate components of the mesh press each other. Contact of a
  /// component with itself is not detected, nor is a step in which one component passes right
  /// through another: steps should be shorter than half of the thinnest part. 4-node tetrahedra
  /// only.
  bool mutual = false;
  /// Penalty stiffness of a pair between two components, ratio as for `penalty`. Points of both
  /// skins lie close together and share the force: with a larger value the set of points with force
  /// jumps between updates; with a fifth of it two blocks of different grids need more than 30
  /// updates.
  double mutual_penalty = 10;
  /// Coulomb's coefficient between the components of the mesh, with `mutual`; 0: none.
  double mutual_friction = 0;
  int max_newton_steps = 40;    ///< for one update of the multipliers
  int max_updates = 30;         ///< of the multipliers, for one step in t; x 4 with friction
  int max_halvings = 7;         ///< of a step in t, in succession
  int refresh_iterations = 30;  ///< after a Newton step with more, a new factor is made
  int max_cg_iterations = 400;  ///< in one Newton step
};

/// m, see ContactState::held_entry. A smaller one is a graze.
inline constexpr double kHeldMatters = 1e-5;

/// One state of the body in equilibrium with the obstacle.
struct ContactState {
  Eigen::Matrix3Xd displacement;  ///< (3 x N) m
  double t = 0;
  double energy = 0;  ///< stored, J
  /// Force of the obstacle on the body, N, and its centre, m: the mean position of the contact
  /// points, weighted by their normal forces; NaN without force.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  int touching = 0;  ///< pairs of contact points and obstacle parts with force
  /// Smallest gap of all near pairs, m, not below -largest_entry * size; infinite if none is near.
  double smallest_gap = 0;
  /// Largest penetration between the contact points, m, >= 0, on a grid four times as fine as
  /// theirs.
  double entry_between = 0;
  /// Largest penetration of skin whose nodes are all held, m, >= 0. Above kHeldMatters the state
  /// says little: how the body gives way beside that skin depends on how deep the obstacle is in
  /// it.
  double held_entry = 0;
  double smallest_force = 0;   ///< N, along the normal, of all pairs that are near: >= 0
  double complementarity = 0;  ///< largest |g f| over (size * the sum of all f)
  double residual = 0;         ///< relative, as ContactSettings::tolerance
  /// With ContactSettings::mutual: (3 x components) N, the force of the others on each component,
  /// in the order of their first nodes; the columns sum to 0. Without it: no columns.
  Eigen::Matrix3Xd mutual_force;
  int mutual_touching = 0;  ///< contact points with force against another component
  /// Smallest gap of the contact points near another component, m, not below -largest_entry * size;
  /// infinite if none is near.
  double smallest_mutual_gap = std::numeric_limits<double>::infinity();
  /// With friction: pairs with force that stick; share of the skin of all pairs with force, and of
  /// those that stick, m^2, in the undeformed body; energy dissipated since the walk began, J. All
  /// of obstacle and components together.
  int sticking = 0;
  double touching_area = 0, sticking_area = 0;
  double dissipated = 0;
  /// With friction: sum over all pairs of how far |t| is from mu f where a point slips, and beyond
  /// it where one sticks, over the sum of mu f.
  double cone_error = 0;
  double smallest_volume_ratio = 1;
  int steps = 0;          ///< in t, since the previous state
  int updates = 0;        ///< of the multipliers, likewise
  int newton_steps = 0;   ///< likewise
  int cg_iterations = 0;  ///< likewise
  int factors = 0;        ///< made, likewise
};

/// Follows the motion of an obstacle, state after state. Several walks may share one solver, each
/// in a thread of its own.
class ContactWalk {
 public:
  /// Begins at t = `begin`, where the obstacle should not touch the body yet. If it does, the first
  /// advance() pushes the body out of it at once, as far as Newton's method converges; if it lies
  /// inside the body, the first advance() fails with Stop::kSwallowed.
  /// @param solver     must outlive this object
  /// @param preloaded  see PathOptions; nullptr: the undeformed body. Must outlive this
  /// @throws Error when the spacing asks for more contact points than memory holds, and for
  ///         10-node tetrahedra with ContactSettings::mutual
  ContactWalk(const EquilibriumSolver& solver, ObstacleMotion motion, double begin,
              const ContactSettings& settings = {}, const Preloaded* preloaded = nullptr);
  ~ContactWalk();
  ContactWalk(ContactWalk&&) noexcept;
  ContactWalk& operator=(ContactWalk&&) noexcept;

  /// Advances to time t in one step, or in halves of it where that fails. Returns false if t was
  /// not reached: now() is then the last state in equilibrium, and why_stopped() the reason.
  bool advance(double t);

  /// As advance(), to a state that is only passed on the way to one that is wanted. With friction,
  /// where the way matters, its residual may be 1000 times as large, its penetration 10 times; the
  /// states behind it change far less than by half the step. advance() to the same t solves it to
  /// the end. Without friction it is advance().
  bool pass(double t);

  /// Changes ContactSettings::friction from the present state on: an obstacle that pressed without
  /// friction, for example, holds the skin where it is then.
  void set_friction(double coefficient);

  [[nodiscard]] const ContactState& now() const;
  [[nodiscard]] Stop stop() const;
  [[nodiscard]] const std::string& why_stopped() const;  ///< empty where nothing failed

  /// (3 x N) N, forces of the obstacle on the nodes at now().
  [[nodiscard]] Eigen::Matrix3Xd nodal_forces() const;
  /// (3 x N) N, forces of the components on each other's nodes at now().
  [[nodiscard]] Eigen::Matrix3Xd mutual_nodal_forces() const;

  [[nodiscard]] double spacing() const;    ///< m, between contact points
  [[nodiscard]] double body_size() const;  ///< m

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
