/// @file
/// Coulomb's friction at one contact point, by return mapping.
/// Internal to this module; contact.h is what others use.
///
///     p  normal force, N        t  friction force on the point, N        mu  Coulomb's coefficient
///     a  anchor: the place on the other side to which the point is held
///     s = P (x - a)             slide, m, in the tangent plane: P = I - n n^T
///
/// Within a minimisation over the displacement, p, n and a are fixed. Then friction has a
/// potential, and the tangent is symmetric:
///
///     q = -k_t s                R = mu p
///     t = q  for |q| <= R       (sticks)        t = R q / |q|  elsewhere (slips)
///     D = (|q|^2 - max(0, |q| - R)^2) / (2 k_t)            t = -dD/dx
///
/// Between minimisations p and n become the present ones. At the end of a step the anchor of a
/// point that slips follows it, a = x + t / k_t, so that exactly the friction force is kept; that
/// of a point that sticks stays (Simo and Laursen, Comput. Struct. 42, 1992). So an obstacle at
/// rest holds the skin for ever.
///
/// A point that sticks is t / k_t away from its anchor, the elastic slip, at most mu p / k_t. It is
/// needed: several points lie on a triangle, whose nodes could not hold all of them exactly.
#pragma once

#include <Eigen/Core>

namespace palpable {

struct Friction {
  double coefficient = 0;  ///< Coulomb's mu; 0: none
  double stiffness = 0;    ///< k_t, ratio to the penalty stiffness of the normal force, > 0
};

struct PointFriction {
  /// Whether the point has an anchor. Without one it has no friction.
  bool anchored = false;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< n
  // Of the last evaluation:
  double limit = 0;                                 ///< R, N; 0: no friction
  double stiffness = 0;                             ///< k_t, N/m
  Eigen::Vector3d slide = Eigen::Vector3d::Zero();  ///< s, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< t, N
  bool slips = false;
};

/// Computes slide and force of a point. @returns D, J
/// @param penalty   stiffness of the normal force, N/m
/// @param pressing  p, N, >= 0
/// @param apart     x - a, m
/// @param glued     the point sticks, whatever force that takes
double evaluate_friction(const Friction& law, double penalty, double pressing,
                         const Eigen::Vector3d& apart, bool glued, PointFriction& point);

/// -dt/dx at the last evaluation, N/m: symmetric and positive semidefinite.
[[nodiscard]] Eigen::Matrix3d friction_stiffness(const PointFriction& point);

/// Turns the point's plane to a new normal. Call this before the multiplier of the normal force is
/// replaced.
/// @param before, now  p, and the normal force that replaces it, N
/// @returns mu |now - before| / k_t, m, where |t| > R / 2: how far the size of the cone is from
/// that
///          to which further updates lead; 0 elsewhere
double update_cone(const Friction& law, double penalty, double before, double now,
                   const Eigen::Vector3d& normal, PointFriction& point);

/// x - a at the end of a step of a point that slips, m: -t / k_t, the elastic slip.
[[nodiscard]] Eigen::Vector3d elastic_slip(const PointFriction& point);

/// Energy that a point dissipates when its anchor follows it, J: 0 if it sticks, else
///
///     -t . (s + t / k_t) = R (|q| - R) / k_t >= 0
[[nodiscard]] double dissipated(const PointFriction& point);

/// Share of a step after which a gap closed that was `before` at its begin and would have become
/// `without` without the contact, m; 0 .. 1. The gap changes linearly.
[[nodiscard]] double time_of_contact(double before, double without);

}  // namespace palpable
