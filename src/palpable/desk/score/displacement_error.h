/// @file
/// How wrong a drawn deformation is, against the true one.
///
///   N  vertices of the true skin
#pragma once

#include <Eigen/Core>

namespace palpable {

struct DisplacementError {
  double relative = 0;  ///< L2 over the skin, against the true displacement's own norm
  double worst = 0;     ///< m, of the vertex that is farthest off
};

/// relative = sqrt( sum a |found - truth|^2 / sum a |truth|^2 ),  a: area of the vertex at rest.
///
/// A body that is left at rest has the relative error 1. Where the truth moves nowhere, it is 0 for
/// a found body that does not either, else infinite.
/// @param truth, found  (3 x N) m, displacement from rest
/// @param areas         (N) m^2, vertex_areas() of the skin at rest
/// @throws ContractViolation when they are not of one skin
[[nodiscard]] DisplacementError displacement_error(const Eigen::Matrix3Xd& truth,
                                                   const Eigen::Matrix3Xd& found,
                                                   const Eigen::VectorXd& areas);

}  // namespace palpable
