/// @file
/// Coulomb's friction at one contact point, by an augmented Lagrangian with return mapping.
/// Internal to this module; contact.h is what others use.
///
///     p  normal force, N        t  friction force on the point, N        mu  Coulomb's coefficient
///     a  anchor: the place on the other side at which the point sticks, or slid to last
///     s = P (x - a)             slide, m, in the tangent plane: P = I - n n^T
///
///     |t| <= mu p               and where |t| < mu p: s = 0; elsewhere s points against t
///
/// Within a minimisation over the displacement, p, n, a and the multiplier of sticking (`shear`,
/// lambda) are fixed. Then friction has a potential, and the tangent is symmetric:
///
///     q = lambda - k_t s        R = mu p
///     t = q  for |q| <= R       (sticks)        t = R q / |q|  elsewhere (slips)
///     D = (|q|^2 - max(0, |q| - R)^2) / (2 k_t)            t = -dD/dx
///
/// Between minimisations lambda <- t, and p and n become the present ones (Simo and Laursen,
/// Comput. Struct. 42, 1992; Alart and Curnier 1991). At convergence a point that sticks has s = 0,
/// whatever the stiffness k_t is. What is left of s is an error of the iteration. It does not add
/// up over the steps, because the anchor of a point that sticks stays where it is.
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
  Eigen::Vector3d shear = Eigen::Vector3d::Zero();    ///< lambda, N: in the plane, |lambda| <= mu p
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

/// lambda <- t, at most mu times the new normal force, and turned into the plane of the new normal.
/// Call this before the multiplier of the normal force is replaced.
/// @param before, now  p, and the normal force that replaces it, N
/// @returns |t - lambda| / k_t, m, and where |t| > R / 2 at least mu |now - before| / k_t: how far
///          the point is from the state that further updates lead to
double update_shear(const Friction& law, double penalty, double before, double now,
                    const Eigen::Vector3d& normal, PointFriction& point);

/// Energy that a point dissipated since its anchor was set, J: 0 if it sticks. It is never negative
/// but for rounding: with |lambda| <= R
///
///     -t . s = (R (|q| - R) + R (R - lambda . q / |q|)) / k_t >= 0
///
/// also where the multipliers have not converged.
[[nodiscard]] double dissipated(const PointFriction& point);

/// Share of a step after which a gap closed that was `before` at its begin and would have become
/// `without` without the contact, m; 0 .. 1. The gap changes linearly.
[[nodiscard]] double time_of_contact(double before, double without);

}  // namespace palpable
