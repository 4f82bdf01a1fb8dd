/// @file
/// Cauchy stress of a deformed body.
///
///   N  nodes     E  tetrahedra     rows: xx yy zz xy yz zx, Pa, axes of the body frame
#pragma once

#include "palpable/bake/solid/solid_model.h"
#include "palpable/bake/solid/stress_recovery.h"

#include <Eigen/Core>

namespace palpable {

/// (6 x n) symmetric tensors, xx yy zz xy yz zx.
using StressField = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// (6 x Q E) sigma = P F^T / J at the integration points, those of element e in the columns Q e ..
/// Q e + Q - 1: one point in 4-node tetrahedra, where it is constant; the four of four_point_rule()
/// in 10-node ones.
/// @param u  (3 x N) m
/// @throws Error if an element is inverted (J <= 0) under u
[[nodiscard]] StressField point_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u);

/// (6 x E) the same, averaged over each element's points with their volumes as weights.
[[nodiscard]] StressField element_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u);

/// (6 x N) stress at the nodes, recovered as stress_recovery.h describes.
/// @param recovery  of model.mesh, made once for many states
/// @throws Error if an element is inverted (J <= 0) under u
[[nodiscard]] StressField nodal_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u,
                                              const StressRecovery& recovery);
/// The same for a single state.
[[nodiscard]] StressField nodal_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u);

/// (n) von Mises stress, sqrt(3/2 s : s) with s the deviator, Pa.
[[nodiscard]] Eigen::VectorXd von_mises(const StressField& stress);

/// (3 x n) principal stresses, largest first, Pa.
[[nodiscard]] Eigen::Matrix3Xd principal_stresses(const StressField& stress);

}  // namespace palpable
