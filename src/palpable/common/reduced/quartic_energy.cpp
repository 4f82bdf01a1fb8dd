#include "palpable/common/reduced/quartic_energy.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/reduced/small_cholesky.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Index of the coefficient (i, j, k, l), in any order, among the distinct ones; likewise with three
// or two indices.
template <std::size_t kOrder>
Index place(std::array<Index, kOrder> indices) {
  std::sort(indices.begin(), indices.end());
  Index sum = 0;
  for (std::size_t k = 0; k < kOrder; ++k) {
    sum += distinct_count(indices[k], static_cast<int>(k) + 1);
  }
  return sum;
}

}  // namespace

DistinctCoefficients distinct_coefficients(const QuarticEnergy& energy) {
  const Index n = energy.modes();
  DistinctCoefficients result{energy.K, VectorXd(distinct_count(n, 3)),
                              VectorXd(distinct_count(n, 4))};
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i <= j; ++i) {
      for (Index l = j; l < n; ++l) {
        result.cubic[place<3>({i, j, l})] = energy.C(pair_row(i, j), l);
        for (Index k = j; k <= l; ++k) {
          result.quartic[place<4>({i, j, k, l})] = energy.D(pair_row(i, j), pair_row(k, l));
        }
      }
    }
  }
  return result;
}

QuarticEnergy energy_of(int modes, const DistinctCoefficients& coefficients) {
  const Index n = modes, P = distinct_count(n, 2);
  PALPABLE_EXPECT(n >= 1 && coefficients.quadratic.size() == P &&
                      coefficients.cubic.size() == distinct_count(n, 3) &&
                      coefficients.quartic.size() == distinct_count(n, 4),
                  "coefficients of n modes");
  QuarticEnergy energy{coefficients.quadratic, MatrixXd(P, n), MatrixXd(P, P)};
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i <= j; ++i) {
      for (Index l = 0; l < n; ++l) {
        energy.C(pair_row(i, j), l) = coefficients.cubic[place<3>({i, j, l})];
        for (Index k = 0; k <= l; ++k) {
          energy.D(pair_row(i, j), pair_row(k, l)) = coefficients.quartic[place<4>({i, j, k, l})];
        }
      }
    }
  }
  return energy;
}

QuarticEquilibrium::QuarticEquilibrium(const QuarticEnergy& energy) : energy_(energy) {
  const Index n = energy.modes(), P = n * (n + 1) / 2;
  PALPABLE_EXPECT(n >= 1 && energy.K.size() == P && energy.C.rows() == P && energy.D.rows() == P &&
                      energy.D.cols() == P,
                  "coefficients of n modes");
  for (VectorXd* of_pair : {&products_, &of_pairs_, &quartic_, &cubic_}) of_pair->setZero(P);
  for (MatrixXd* square : {&hessian_, &factor_}) square->setZero(n, n);
  for (VectorXd* of_mode : {&gradient_, &right_, &step_, &trial_}) of_mode->setZero(n);
}

double QuarticEquilibrium::evaluate(const VectorXd& q) {
  const Index n = q.size();
  Index row = 0;
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i <= j; ++i, ++row) products_[row] = (i == j ? 0.5 : 1.0) * q[i] * q[j];
  }
  // With H2 = C q and H3 = 1/2 D qq, the parts of the second derivative,
  //   W' = K q + 1/2 H2 q + 1/3 H3 q   and   W = 1/2 K qq + 1/6 H2 qq + 1/12 H3 qq.
  cubic_.noalias() = energy_.C * q;
  quartic_.noalias() = energy_.D * products_;
  gradient_.setZero();
  double W = 0.0;
  row = 0;
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i <= j; ++i, ++row) {
      const double force = energy_.K[row] + 0.5 * cubic_[row] + quartic_[row] / 3.0;
      const double work = 0.5 * energy_.K[row] + cubic_[row] / 6.0 + quartic_[row] / 12.0;
      gradient_[i] += force * q[j];
      if (i != j) gradient_[j] += force * q[i];
      W += (i == j ? 1.0 : 2.0) * work * q[i] * q[j];
      hessian_(i, j) = hessian_(j, i) = energy_.K[row] + cubic_[row] + quartic_[row];
    }
  }
  return W;
}

bool QuarticEquilibrium::newton_step(double shift) {
  factor_ = hessian_;
  for (Index i = 0; i < right_.size(); ++i) factor_(i, i) += shift * energy_.K[pair_row(i, i)];
  if (!factorise_small(factor_)) return false;
  step_ = right_;
  solve_lower(factor_, step_);
  solve_upper(factor_, step_);
  return true;
}

QuarticEquilibrium::Answer QuarticEquilibrium::solve(const VectorXd& f, VectorXd& q) {
  constexpr double kTolerance = 1e-6;
  constexpr int kMostSteps = 60, kMostHalvings = 12;
  PALPABLE_EXPECT(f.size() == gradient_.size() && q.size() == f.size(), "a value for each mode");
  Answer answer;
  const double size = f.norm();
  if (size == 0.0) {
    q.setZero();
    answer.converged = true;
    return answer;
  }
  double energy = evaluate(q) - f.dot(q);
  for (;; ++answer.steps) {
    right_ = f - gradient_;
    answer.residual = right_.norm() / size;
    answer.converged = answer.residual <= kTolerance;
    if (answer.converged || answer.steps == kMostSteps) return answer;
    double shift = 0.0;
    while (!newton_step(shift)) {
      shift = shift == 0.0 ? 0.01 : 4.0 * shift;
      if (!(shift < 1e9)) return answer;  // some value is not a number
    }
    double share = 1.0, trial_energy = 0.0;
    int halvings = 0;
    for (; halvings < kMostHalvings; ++halvings, share *= 0.5) {
      trial_ = q + share * step_;
      trial_energy = evaluate(trial_) - f.dot(trial_);
      // The tolerance allows for rounding: the last steps change the energy by less than its
      // rounding error.
      if (trial_energy <= energy + 1e-12 * std::abs(energy)) break;
    }
    if (halvings == kMostHalvings) {
      (void)evaluate(q);
      return answer;
    }
    q = trial_;
    energy = trial_energy;
  }
}

}  // namespace palpable
