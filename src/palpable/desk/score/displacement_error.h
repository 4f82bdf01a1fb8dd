/// @file
/// The error of a drawn deformation with respect to the true one.
///
///   N  vertices of the true skin
#pragma once

#include <Eigen/Core>

namespace palpable {

struct DisplacementError {
  double relative = 0;  ///< L2 norm over the skin, relative to that of the truth
  double worst = 0;     ///< m, largest error of a vertex
};

///     relative = sqrt( sum a |found - truth|^2 / sum a |truth|^2 ),  a: area of the vertex at rest
///
/// A body that is drawn at rest has a relative error of 1. If the true displacement is 0
/// everywhere, the relative error is 0 when the found one is 0, too, and otherwise infinite.
/// @param truth, found  (3 x N) m, displacement from rest
/// @param areas         (N) m^2, vertex_areas() of the skin at rest
/// @throws ContractViolation when the sizes differ or are 0
[[nodiscard]] DisplacementError displacement_error(const Eigen::Matrix3Xd& truth,
                                                   const Eigen::Matrix3Xd& found,
                                                   const Eigen::VectorXd& areas);

}  // namespace palpable
