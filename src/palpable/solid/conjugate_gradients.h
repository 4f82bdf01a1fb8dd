/// @file
/// Conjugate gradients with a factor of a similar matrix as preconditioner.
#pragma once

#include <Eigen/Core>

#include <functional>

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

/// y = A x; a symmetric positive definite A is hoped for.
using LinearMap = std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)>;

struct CgSystem {
  LinearMap K;
  LinearMap preconditioner;  ///< x ~= K^-1 b
  /// Called for each direction s that was stepped along, and K s; may be empty.
  std::function<void(const Eigen::VectorXd& s, const Eigen::VectorXd& Ks)> visit = {};
};

/// Solves K x = b from x = 0 until |b - K x|_2 <= relative_tolerance |b|_2.
///
/// Ends with kNegativeCurvature as soon as a direction p has p.Kp <= 0: K is not positive definite
/// and x (so far) is not to be trusted as a Newton step. That a direction is not met does not prove
/// that K has none.
CgResult conjugate_gradients(const CgSystem& system, const Eigen::VectorXd& b,
                             double relative_tolerance, int max_iterations, Eigen::VectorXd& x,
                             CgScratch& scratch);

}  // namespace palpable
