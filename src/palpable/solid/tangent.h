/// @file
/// How the derivative of a stress is laid out, once for all laws.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// dP/dF, Pa. P and F are read column by column, as Eigen stores them:
///
///     A(i + 3 J, k + 3 L) = dP_iJ / dF_kL
///
/// so that the 3 x 3 block (J, L) acts between the directions J and L of the undeformed body.
/// Symmetric, because P = dPsi/dF.
using Tangent = Eigen::Matrix<double, 9, 9>;

}  // namespace palpable
