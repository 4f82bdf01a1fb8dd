/// @file
/// The energy of a body in its modes, packed for its touch: its gradient and its second derivative
/// at the cost of reading a quarter of it.
#pragma once

#include "palpable/reduced/quartic_energy.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// In single precision, the quartic part once instead of twice: what an evaluation reads is what it
/// costs. Rounding is 1e-7 of the forces.
///
///   n  modes     P = n (n + 1) / 2  their pairs
class PackedEnergy {
 public:
  explicit PackedEnergy(const QuarticEnergy& energy);

  /// W' and W'' at q, as QuarticEquilibrium has them. Allocates nothing once the results have their
  /// size. @param q  (n)  @param gradient  (n)  @param hessian  (n x n)
  void evaluate(const Eigen::VectorXd& q, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian);

 private:
  Eigen::Index n_;
  Eigen::VectorXd K_;                           // (P)
  Eigen::MatrixXf C_;                           // (P x n)
  Eigen::VectorXf products_, quartic_, cubic_;  // (P)
  std::vector<float> D_;                        // row by row from the diagonal on
};

}  // namespace palpable
