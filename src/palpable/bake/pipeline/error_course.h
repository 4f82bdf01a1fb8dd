/// @file
/// The course of the errors over the number of modes, as a body file states it.
#pragma once

#include "palpable/bake/separate/reduction.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// The course as a body file stores it: at most about a million errors. The first numbers of modes
/// are all kept, later ones in equal steps of their logarithm.
[[nodiscard]] ErrorCourse course_of(const Reduction& reduction);

/// Up to `count` of the numbers 1 .. most, always with 1 and `most`: all of them, or the first ones
/// and then some in equal ratios.
/// @pre count >= 2
[[nodiscard]] Eigen::VectorXi some_of(int most, int count);

/// The error of the von Mises stress on the skin against the number of modes (of each site), as the
/// live half evaluates them: |vM - vM_m| / |vM|, where |.|^2 is an integral over the skin. Numbers
/// of modes: some_of(largest block, 12).
///   V  vertices   K  snapshots
class VonMisesCourse {
 public:
  /// @param stress  (6V) over site and more; outlives this
  /// @param areas   (V) of the vertices, m^2
  VonMisesCourse(const SeparatedField& stress, Eigen::VectorXd areas, Eigen::Index snapshots);

  /// Snapshot k, 0 .. K - 1, each once. @param truth  (6V) Pa
  void add(Eigen::Index k, std::span<const double> mu, const Eigen::VectorXf& truth);

  [[nodiscard]] ErrorCourse result() const;

 private:
  [[nodiscard]] double integral(const Eigen::VectorXf& of_square) const;

  const SeparatedField& stress_;
  Eigen::VectorXd areas_;
  Eigen::VectorXi modes_;  // (q)
  Eigen::MatrixXd lost_;   // (K x q) squares
  Eigen::VectorXd whole_;  // (K)
  Eigen::VectorXf weights_, sigma_, vm_, vm_truth_;
};

}  // namespace palpable
