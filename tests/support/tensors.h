/// @file
/// Snapshot tensors whose reduction is known, or that resemble those of a body.
#pragma once

#include "palpable/bake/separate/snapshot_tensor.h"

#include <Eigen/Core>

#include <cmath>
#include <random>
#include <vector>

namespace palpable::test {

inline Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns,
                                     std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd A(rows, columns);
  for (double& x : A.reshaped()) x = normal(random);
  return A;
}

inline Eigen::VectorXd random_weights(Eigen::Index n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.5, 2.0);
  Eigen::VectorXd w(n);
  for (double& x : w) x = uniform(random);
  return w;
}

/// A sum of `rank` separated terms, each `ratio` times the previous one.
inline SeparatedTensor random_separated(Eigen::Index N, const std::vector<int>& sizes,
                                        Eigen::Index rank, double ratio, std::mt19937_64& random) {
  SeparatedTensor separated{random_matrix(N, rank, random), {}};
  for (const int n : sizes) separated.G.push_back(random_matrix(n, rank, random));
  for (Eigen::Index i = 0; i < rank; ++i) {
    separated.F.col(i) *= std::pow(ratio, static_cast<double>(i));
  }
  return separated;
}

/// A pressed body in miniature: the first parameter selects the position of a dent, which grows
/// with the second one more than linearly. It has full rank, as a body's snapshots have.
inline SnapshotTensor dents(int N, int sites, int levels) {
  SnapshotTensor snapshots{Eigen::MatrixXd(N, sites * levels), {sites, levels}};
  for (int s = 0; s < sites; ++s) {
    for (int l = 0; l < levels; ++l) {
      const double place = (s + 0.5) / sites, depth = (l + 1.0) / levels;
      for (int n = 0; n < N; ++n) {
        const double x = (n + 0.5) / N - place;
        snapshots.values(n, s * levels + l) =
            depth * std::exp(-40.0 * x * x * (1.0 + 0.4 * depth)) + 0.2 * depth * depth * x;
      }
    }
  }
  return snapshots;
}

/// Hilbert's tensor, 1 / (i + j + k ... + 1): its singular values decrease fast but are never 0.
inline SnapshotTensor hilbert(int N, const std::vector<int>& sizes) {
  const Eigen::Index K = snapshot_count(sizes);
  SnapshotTensor tensor{Eigen::MatrixXd(N, K), sizes};
  for (Eigen::Index k = 0; k < K; ++k) {
    Eigen::Index rest = k, sum = 1;
    for (std::size_t j = sizes.size(); j-- > 0;) {
      sum += rest % sizes[j];
      rest /= sizes[j];
    }
    for (int n = 0; n < N; ++n) tensor.values(n, k) = 1.0 / static_cast<double>(n + sum);
  }
  return tensor;
}

}  // namespace palpable::test
