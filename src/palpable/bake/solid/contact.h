/// @file
/// The full answer of a hyperelastic body to rigid obstacles: unilateral contact at the contact
/// points of its skin (contact_points.h), without friction unless it is asked for, by an augmented
/// Lagrangian (contact_pairs.h).
///
///     internal_force(u) = preload + sum f_i n_i N(x_i)        at the free nodes
///     g_i(u) >= 0,   f_i >= 0,   g_i f_i = 0                  at every contact point
///
///   N  nodes      u  displacement, (3 x N) m      t  time along the obstacle's way
///
/// The bodies of one mesh that share no node (joined_model.h) press each other, too, where that is
/// asked for (ContactSettings::mutual): contact points of each against the triangles of the others,
/// both deformable, solved together (mutual_pairs.h).
///
/// Newton's method with a line search on the Lagrangian, conjugate gradients for its steps; the
/// factor that preconditions them is one of the tangent with the contact's stiffness in it.
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
  /// Of the residual at the free nodes, relative to the contact's forces (or those that hold the
  /// body, if larger).
  double tolerance = 1e-7;
  /// Of the body's size, the diagonal of its box: how far a contact point may be inside.
  double largest_entry = 1e-6;
  /// m between contact points; 0: half the smallest radius of the obstacle, but no more than a
  /// third of the skin's mean edge. A tip that is smaller than the spacing passes between them.
  double spacing = 0;
  /// Of the nodes' own stiffness: the penalty of a contact point. More means fewer updates of the
  /// multipliers, and worse conditioned steps: where a slender body is pushed by much more than
  /// its own size of element in a step, 5 is several times as fast.
  double penalty = 200;
  /// Coulomb's coefficient between obstacle and skin. With friction the answer depends on the way,
  /// step by step: a point slides along the straight line between two steps.
  double friction = 0;
  /// m, as a share of the body's size: a point that slides by less in a step is held by less than
  /// friction's whole force.
  double sticking = 1e-4;
  /// Whether the separate components of the mesh keep each other out, without friction. Not what a
  /// component does to itself. A step in which one goes right through the other is not noticed:
  /// steps should be shorter than half of what is thinnest. 4-node tetrahedra only.
  bool mutual = false;
  /// The penalty of a pair between two components, as `penalty`. Points of both sides lie close to
  /// each other and share what presses: more makes the choice of those that press jump, a fifth of
  /// it takes more than 30 updates between two blocks of different grids.
  double mutual_penalty = 10;
  int max_newton_steps = 40;    ///< of one update
  int max_updates = 30;         ///< of the multipliers
  int max_halvings = 7;         ///< of a step in t, in succession
  int refresh_iterations = 30;  ///< a Newton step that takes more gets a new factor after it
  int max_cg_iterations = 400;  ///< of one Newton step
};

/// A state of the body against the obstacle.
struct ContactState {
  Eigen::Matrix3Xd displacement;  ///< (3 x N) m
  double t = 0;
  double energy = 0;  ///< stored, J
  /// N, of the obstacle on the body, and the place where it acts: the mean of the contact points by
  /// their forces, m; NaN without force.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  int touching = 0;         ///< pairs of contact points and obstacle parts with force
  double smallest_gap = 0;  ///< m, of all contact points; not below -largest_entry * size
  /// m, >= 0: how deep the obstacle is at worst between the contact points, on a grid four times as
  /// fine.
  double entry_between = 0;
  double smallest_force = 0;   ///< N, along the normal, of all contact points: >= 0
  double complementarity = 0;  ///< largest |g f| over (size * the sum of all f)
  double residual = 0;         ///< relative, as ContactSettings::tolerance
  /// With ContactSettings::mutual, (3 x components, by their first node) N on each by the others;
  /// they sum to 0. Else no columns.
  Eigen::Matrix3Xd mutual_force;
  int mutual_touching = 0;  ///< contact points with force against another component
  /// m, of the contact points near another component, not below -largest_entry * size; infinite if
  /// none is near.
  double smallest_mutual_gap = std::numeric_limits<double>::infinity();
  double smallest_volume_ratio = 1;
  int steps = 0;          ///< in t, since the state before
  int updates = 0;        ///< of multipliers, likewise
  int newton_steps = 0;   ///< likewise
  int cg_iterations = 0;  ///< likewise
  int factors = 0;        ///< made, likewise
};

/// Follows an obstacle on its way. Several may share one solver, each in a thread of its own.
class ContactWalk {
 public:
  /// Begins at `begin`, where the obstacle should not touch yet; if it does, the body is pressed
  /// out of it at once, as far as Newton's method can. An obstacle that lies inside the body there
  /// is refused by the first advance().
  /// @param solver     outlives this
  /// @param preloaded  see PathOptions; nullptr: the undeformed body. Outlives this
  /// @throws Error when the spacing asks for more contact points than memory holds, and for
  ///         10-node tetrahedra with ContactSettings::mutual
  ContactWalk(const EquilibriumSolver& solver, ObstacleMotion motion, double begin,
              const ContactSettings& settings = {}, const Preloaded* preloaded = nullptr);
  ~ContactWalk();
  ContactWalk(ContactWalk&&) noexcept;
  ContactWalk& operator=(ContactWalk&&) noexcept;

  /// The state at time t, by one step, or by halves of it where that fails. False: now() is the
  /// last state that was reached, why_stopped() says why there is no further one.
  bool advance(double t);

  [[nodiscard]] const ContactState& now() const;
  [[nodiscard]] Stop stop() const;
  [[nodiscard]] const std::string& why_stopped() const;  ///< empty where nothing failed

  /// (3 x N) N of the obstacle at the nodes, at now().
  [[nodiscard]] Eigen::Matrix3Xd nodal_forces() const;
  /// (3 x N) N of the components on each other at the nodes, at now().
  [[nodiscard]] Eigen::Matrix3Xd mutual_nodal_forces() const;

  [[nodiscard]] double spacing() const;    ///< m, of the contact points
  [[nodiscard]] double body_size() const;  ///< m

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
