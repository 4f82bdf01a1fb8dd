#include "palpable/bake/solid/conjugate_gradients.h"

namespace palpable {

CgResult conjugate_gradients(const CgSystem& system, const Eigen::VectorXd& b,
                             double relative_tolerance, int max_iterations, Eigen::VectorXd& x,
                             CgScratch& scratch) {
  auto& [r, z, p, Kp] = scratch;
  x.setZero(b.size());
  r = b;
  const double goal = relative_tolerance * b.norm();
  CgResult result;
  if (r.norm() <= goal) return result;
  system.preconditioner(r, z);
  p = z;
  double rz = r.dot(z);
  while (result.iterations < max_iterations) {
    system.K(p, Kp);
    const double curvature = p.dot(Kp);
    if (!(curvature > 0.0)) {
      result.end = CgEnd::kNegativeCurvature;
      return result;
    }
    ++result.iterations;
    const double step = rz / curvature;
    x += step * p;
    r -= step * Kp;
    if (system.visit) system.visit(p, Kp);
    if (r.norm() <= goal) return result;
    system.preconditioner(r, z);
    const double rz_before = rz;
    rz = r.dot(z);
    if (!(rz > 0.0)) break;  // to rounding, the preconditioner is not positive definite here
    p = z + (rz / rz_before) * p;
  }
  result.end = CgEnd::kTooManyIterations;
  return result;
}

}  // namespace palpable
