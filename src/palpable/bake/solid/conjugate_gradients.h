/// @file
/// Preconditioned conjugate gradients that report negative curvature.
#pragma once

#include <Eigen/Core>

#include <functional>

namespace palpable {

enum class CgEnd { kConverged, kNegativeCurvature, kTooManyIterations };

struct CgResult {
  CgEnd end = CgEnd::kConverged;
  int iterations = 0;
};

/// Work vectors. Reused between calls of one size, so that only the first call allocates.
struct CgScratch {
  Eigen::VectorXd r, z, p, Kp;
};

/// y = A x with a symmetric A; conjugate_gradients() finds out whether it is positive definite.
using LinearMap = std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)>;

/// The system to solve, and a callback for the iterations.
struct CgSystem {
  LinearMap K;
  LinearMap preconditioner;  ///< x ~= K^-1 b
  /// Called in each iteration with its search direction s and K s; may be empty.
  std::function<void(const Eigen::VectorXd& s, const Eigen::VectorXd& Ks)> visit = {};
};

/// Solves K x = b from x = 0 until |b - K x|_2 <= relative_tolerance |b|_2.
///
/// Ends with kNegativeCurvature as soon as a search direction p has p.Kp <= 0: then K is not
/// positive definite, and x must not be used as a Newton step. Any other end does not prove that K
/// is positive definite.
CgResult conjugate_gradients(const CgSystem& system, const Eigen::VectorXd& b,
                             double relative_tolerance, int max_iterations, Eigen::VectorXd& x,
                             CgScratch& scratch);

}  // namespace palpable
