/// @file
/// The energy of a body in its modes, packed for its touch: its gradient and its second derivative
/// at the cost of reading a quarter of it.
#pragma once

#include "palpable/common/material/simd.h"
#include "palpable/common/reduced/quartic_energy.h"

#include <Eigen/Core>

#include <memory>

namespace palpable {

/// In single precision, the quartic part once instead of twice: what an evaluation reads is what it
/// costs. Rounding is 1e-7 of the forces.
///
///   n  modes     P = n (n + 1) / 2  their pairs
class PackedEnergy {
 public:
  explicit PackedEnergy(const QuarticEnergy& energy, SimdLevel level = best_simd_level());
  ~PackedEnergy();
  PackedEnergy(PackedEnergy&&) noexcept;

  /// W' and W'' at q, as QuarticEquilibrium has them. Allocates nothing once the results have their
  /// size; the same bytes on every processor. @param q  (n)  @param gradient  (n)
  /// @param hessian  (n x n)
  void evaluate(const Eigen::VectorXd& q, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
