/// @file
/// Augmented Lagrangian of unilateral contact: what each contact point and each part of the
/// obstacle add to energy, forces and tangent.
/// Internal to this module; contact.h is what others use.
///
///     g >= 0, p >= 0, g p = 0      g  gap of a point x to a part, m      p  its force, N
///
///     L(u, p) = Psi(u) + sum 1/(2 k) ( max(0, p - k g(u))^2 - p^2 ),    k  penalty, N/m
///
/// At a minimum over u the force f = max(0, p - k g) balances the body; p <- f then brings both
/// closer, by a factor of about 1 / (1 + k * compliance) each time (Alart and Curnier, Comput.
/// Methods Appl. Mech. Eng. 92, 1991). At the end g f = 0 to rounding, whatever k is.
///
/// Coulomb's friction, where it is asked for, is a potential of the step: with s the way that a
/// point has slid over its part since the step began, square to the normal,
///
///     D(u) = sum mu p h(|s|)      h(y) = y^2 / (2 e)  up to e,  y - e / 2  beyond
///
/// so that it resists by mu p where it slides by more than e, and by less where it sticks. p and
/// the normal are those of the update before, which the updates make the present ones.
#pragma once

#include "palpable/bake/solid/block_matrix.h"
#include "palpable/bake/solid/contact_points.h"
#include "palpable/bake/solid/obstacle.h"
#include "palpable/bake/solid/tet_assembly.h"

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace palpable {

/// One contact point against one part of the obstacle.
struct ContactPair {
  int point = 0, part = 0;
  double penalty = 0;     ///< N/m
  double multiplier = 0;  ///< N, >= 0
  Gap gap;                ///< at the last evaluation
  double force = 0;       ///< N, along the gap's normal, on the body
  /// With friction: whether the point pressed when the step began, and so may rub; where it would
  /// be if it had stuck since, m; the normal that the slide is square to; the slide, m; and the
  /// force on the body, N.
  bool rubs = false;
  Eigen::Vector3d stuck = Eigen::Vector3d::Zero(), slide_normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d slide = Eigen::Vector3d::Zero(), friction = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d whole_force() const { return force * gap.normal + friction; }
};

struct Friction {
  double coefficient = 0;  ///< Coulomb's mu; 0: none
  double sticking = 0;     ///< m, e above
};

/// The pairs that are near enough to matter, and their sums.
class ContactPairs {
 public:
  /// All arguments outlive this.
  /// @param penalties  (C) N/m of each point
  ContactPairs(const TetAssembly& assembly, const Boundary& boundary, const ContactPoints& points,
               const Eigen::VectorXd& penalties, const Friction& friction = {});

  [[nodiscard]] const std::vector<ContactPair>& pairs() const { return pairs_; }

  /// Sees to it that all pairs nearer than `margin` are there, and forgets those without force that
  /// are farther. @returns how many that touch (gap below 0) are new
  int find(const ObstacleGaps& gaps, const Eigen::Matrix3Xd& positions, double margin);

  /// With friction, before each step: from here on points slide. Where the obstacle and the nodes
  /// were when the step began.
  void begin_step(const ObstacleGaps& gaps, const Obstacle& before,
                  const Eigen::Matrix3Xd& positions_before);

  /// Gaps and forces at `positions`. @returns sum of 1/(2 k) (f^2 - p^2) and of
  /// D, J
  /// @param glued  points that were pressed stay on the obstacle: f = p - k g may pull, too
  double evaluate(const ObstacleGaps& gaps, const Eigen::Matrix3Xd& positions, bool glued = false);

  /// Adds the forces of the last evaluation to those of the nodes, (3 x N) N.
  void add_forces(Eigen::Matrix3Xd& force) const;

  /// y += tangent x, both (3M) in the free directions, after evaluate().
  /// @param bent  with the curvature of the obstacle: the whole derivative, which may lack
  ///              positive definiteness; else without it
  void add_product(const Eigen::VectorXd& x, bool bent, Eigen::VectorXd& y) const;

  /// K += tangent without the curvature.
  void add_tangent(BlockMatrix& K) const;

  /// p <- f. @returns the largest |f - p| / k, m: how far points are inside, or forces at points
  /// that are outside still have to fall
  double update_multipliers();

  /// An obstacle may have another number of parts than the one before: a cup comes, a hand leaves.
  /// Then the numbers of its parts mean others, and each pair that pressed goes on against the part
  /// that is nearest to its point now; the rest is forgotten. Does nothing for as many parts.
  void take_up(const ObstacleGaps& gaps, const Eigen::Matrix3Xd& positions);

  /// To put pairs back as they were, after a step that failed.
  struct Saved {
    std::vector<ContactPair> pairs;
    int parts = 0;
  };
  [[nodiscard]] Saved save() const { return {pairs_, parts_}; }
  void restore(Saved saved) {
    pairs_ = std::move(saved.pairs);
    parts_ = saved.parts;
  }

 private:
  [[nodiscard]] bool has(int point, int part) const;
  [[nodiscard]] double most_friction(const ContactPair& pair) const;
  double rub(const Eigen::Vector3d& x, ContactPair& pair) const;
  [[nodiscard]] Eigen::Matrix3d stiffness(const ContactPair& pair) const;

  const Boundary& boundary_;
  const ContactPoints& points_;
  const Eigen::VectorXd& penalties_;
  Friction friction_;
  std::vector<int> free_of_node_;
  Eigen::VectorXd mask_;            // (3M) 1, and 0 in held directions
  std::vector<ContactPair> pairs_;  // ordered by point, then part
  int parts_ = 0;                   // of the obstacle that they press against
};

}  // namespace palpable
