/// @file
/// The energy of a body in its modes, packed for contact: its gradient and second derivative are
/// evaluated by reading a quarter of the bytes of QuarticEnergy.
#pragma once

#include "palpable/common/material/simd.h"
#include "palpable/common/reduced/quartic_energy.h"

#include <Eigen/Core>

#include <memory>

namespace palpable {

/// Single precision, and of the symmetric quartic part one half: the cost of an evaluation is that
/// of reading the numbers. Rounding is 1e-7 of the forces.
///
///   n  modes     P = n (n + 1) / 2  pairs of modes
class PackedEnergy {
 public:
  explicit PackedEnergy(const QuarticEnergy& energy, SimdLevel level = best_simd_level());
  ~PackedEnergy();
  PackedEnergy(PackedEnergy&&) noexcept;

  /// W' and W'' at q, as QuarticEquilibrium computes them. Allocates nothing once the results have
  /// their size; the same bytes on every processor. @param q  (n)  @param gradient  (n)
  /// @param hessian  (n x n)
  void evaluate(const Eigen::VectorXd& q, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
