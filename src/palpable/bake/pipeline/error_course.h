/// @file
/// What the body file says about how errors fall with the number of modes.
#pragma once

#include "palpable/bake/separate/reduction.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// As the body file keeps it: of long courses at most about a million errors, the first numbers of
/// modes all, later ones in equal steps of their logarithm.
[[nodiscard]] ErrorCourse course_of(const Reduction& reduction);

/// Up to `count` numbers 1 .. most: all, or the first ones and then in equal ratios; 1 and `most`
/// always. For count >= 2.
[[nodiscard]] Eigen::VectorXi some_of(int most, int count);

/// Von Mises stress on the skin after the first modes (of each site) of a field as the live half
/// evaluates it, against the snapshots: |vM - vM_m| / |vM|, an integral over the skin. Numbers of
/// modes: some_of(largest block, 12).
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
