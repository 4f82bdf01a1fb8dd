#include "palpable/common/contact/complementarity.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

// Steps without fewer wrong points until the points change sides one at a time.
constexpr int kBlockTries = 3;
// Largest number of factorisations of a solve.
constexpr int kMostSteps = 200;
// A force or gap below 0 by less than this counts as 0; ratio to the largest force or gap.
constexpr double kRounding = 1e-10;

// Replaces the lower triangle of A by L, L L^T = A, row by row. False if A is not positive
// definite. Each column is subtracted from the rows below at once, along the rows, which
// vectorises.
// @param column  (n) scratch
bool factorise(double* A, int n, double* column) {
  for (int k = 0; k < n; ++k) {
    const double pivot = A[static_cast<std::ptrdiff_t>(k) * n + k];
    if (!(pivot > 0)) return false;
    const double inverse = 1.0 / std::sqrt(pivot);
    for (int i = k; i < n; ++i) {
      double& entry = A[static_cast<std::ptrdiff_t>(i) * n + k];
      entry *= inverse;
      column[i] = entry;
    }
    for (int i = k + 1; i < n; ++i) {
      double* row = A + static_cast<std::ptrdiff_t>(i) * n;
      const double factor = column[i];
      for (int j = k + 1; j <= i; ++j) row[j] -= factor * column[j];
    }
  }
  return true;
}

void substitute(const double* L, int n, double* x) {
  for (int i = 0; i < n; ++i) {
    const double* row = L + static_cast<std::ptrdiff_t>(i) * n;
    double sum = x[i];
    for (int k = 0; k < i; ++k) sum -= row[k] * x[k];
    x[i] = sum / row[i];
  }
  for (int i = n - 1; i >= 0; --i) {
    const double* row = L + static_cast<std::ptrdiff_t>(i) * n;
    x[i] /= row[i];
    for (int k = 0; k < i; ++k) x[k] -= row[k] * x[i];
  }
}

}  // namespace

Complementarity::Complementarity(int most)
    : most_(most),
      presses_(static_cast<std::size_t>(most)),
      factor_(static_cast<std::size_t>(most) * static_cast<std::size_t>(most)),
      f_(static_cast<std::size_t>(most)),
      column_(static_cast<std::size_t>(most)) {
  PALPABLE_EXPECT(most >= 1, "a problem has points");
  pressing_.reserve(static_cast<std::size_t>(most));
}

// Computes into f_ the forces at which all pressing points have gap 0.
bool Complementarity::solve_pressing(std::span<const double> W, std::span<const double> q) {
  ++steps_;
  const std::size_t m = q.size();
  pressing_.clear();
  for (std::size_t i = 0; i < m; ++i) {
    if (presses_[i] != 0) pressing_.push_back(static_cast<int>(i));
  }
  const int n = static_cast<int>(pressing_.size());
  for (int i = 0; i < n; ++i) {
    const double* row = W.data() + static_cast<std::size_t>(pressing_[i]) * m;
    double* to = factor_.data() + static_cast<std::ptrdiff_t>(i) * n;
    for (int j = 0; j <= i; ++j) to[j] = row[pressing_[j]];
  }
  if (!factorise(factor_.data(), n, column_.data())) return false;
  for (int i = 0; i < n; ++i) f_[i] = -q[pressing_[i]];
  substitute(factor_.data(), n, f_.data());
  return true;
}

double Complementarity::gap(std::span<const double> W, std::span<const double> q, int i) const {
  const auto m = static_cast<std::ptrdiff_t>(q.size());
  double sum = q[i];
  for (std::size_t k = 0; k < pressing_.size(); ++k) {
    const int j = pressing_[k];
    sum += W[i >= j ? i * m + j : j * m + i] * f_[k];
  }
  return sum;
}

bool Complementarity::solve(std::span<const double> W, std::span<const double> q,
                            std::span<double> f) {
  const int m = static_cast<int>(q.size());
  PALPABLE_EXPECT(m <= most_ && f.size() == q.size() && W.size() == q.size() * q.size(),
                  "a problem of at most as many points as there is memory for");
  steps_ = 0;
  double most_q = 0;
  for (const double value : q) most_q = std::max(most_q, std::abs(value));
  for (int i = 0; i < m; ++i) presses_[i] = f[i] > 0;
  int least_wrong = m + 1, tries = kBlockTries;
  bool done = false;
  while (steps_ < kMostSteps) {
    if (!solve_pressing(W, q)) {
      std::fill(f.begin(), f.end(), 0.0);
      return false;
    }
    double most_f = 0;
    for (std::size_t k = 0; k < pressing_.size(); ++k) most_f = std::max(most_f, std::abs(f_[k]));
    // Points on the wrong side: those that pull, and those that enter without pressing.
    int wrong = 0, last = -1;
    std::size_t k = 0;
    for (int i = 0; i < m; ++i) {
      const bool is_wrong =
          presses_[i] != 0 ? f_[k++] < -kRounding * most_f : gap(W, q, i) < -kRounding * most_q;
      f[i] = is_wrong ? 1 : 0;  // a mark until the end
      wrong += is_wrong;
      if (is_wrong) last = i;
    }
    if (wrong == 0) {
      done = true;
      break;
    }
    if (wrong < least_wrong) {
      least_wrong = wrong;
      tries = kBlockTries;
    } else {
      --tries;
    }
    for (int i = 0; i < m; ++i) {
      if (f[i] != 0 && (tries > 0 || i == last)) presses_[i] ^= 1;
    }
  }
  std::fill(f.begin(), f.end(), 0.0);
  for (std::size_t k = 0; k < pressing_.size(); ++k) f[pressing_[k]] = std::max(0.0, f_[k]);
  return done;
}

}  // namespace palpable
