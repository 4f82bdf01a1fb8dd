/// @file
/// Conjugate gradients with a Cholesky factor of a similar matrix as preconditioner.
#pragma once

#include "palpable/solid/block_matrix.h"
#include "palpable/solid/sparse_cholesky.h"

#include <Eigen/Core>

namespace palpable {

enum class CgEnd { kConverged, kNegativeCurvature, kTooManyIterations };

struct CgResult {
  CgEnd end = CgEnd::kConverged;
  int iterations = 0;
};

/// Vectors kept from one call to the next, so that only the first allocates.
struct CgScratch {
  Eigen::VectorXd r, z, p, Kp;
};

/// Solves K x = b from x = 0 until |b - K x|_2 <= relative_tolerance |b|_2.
///
/// Ends with kNegativeCurvature as soon as a direction p has p.Kp <= 0: K is not positive definite
/// and x (so far) is not to be trusted as a Newton step. That a direction is not met does not prove
/// that K has none.
CgResult conjugate_gradients(const BlockMatrix& K, const CholeskyFactor& preconditioner,
                             const Eigen::VectorXd& b, double relative_tolerance,
                             int max_iterations, Eigen::VectorXd& x, CgScratch& scratch,
                             FactorWorkspace& workspace);

}  // namespace palpable
