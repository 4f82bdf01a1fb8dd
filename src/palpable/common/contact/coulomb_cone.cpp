#include "palpable/common/contact/coulomb_cone.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/dense_solve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {
namespace {

// Rounds of normal forces and friction at most.
constexpr int kMostRounds = 9;
// Ratio of the residuals after and before a round, above which further ones are not worth their
// time: the next iteration of the contact goes on from there.
constexpr double kStalls = 0.8;
constexpr int kSweeps = 20;
// Ratio to the tolerance: sweeps end when none of them moves a point farther.
constexpr double kSweepTolerance = 0.2;
// Newton's method: steps at most, and unknowns. A step with as many takes 2 to 3 ms; a larger
// problem has the rounds alone.
constexpr int kNewtonSteps = 4;
constexpr std::size_t kMostUnknowns = 192;
// Steps of Newton's method for the multiplier of a point that slides; they converge from below.
constexpr int kSecularSteps = 8;

struct DiscPoint {
  double x = 0, y = 0;
};

// std::hypot() is not rounded correctly, and differs between machines.
double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

// The minimum of 1/2 t A t + r t over the disc |t| <= radius, A symmetric positive definite.
DiscPoint minimum_on_disc(double a, double b, double c, DiscPoint r, double radius) {
  if (!(radius > 0)) return {};
  double shift = 0;
  DiscPoint t;
  for (int step = 0; step <= kSecularSteps; ++step) {
    const double aa = a + shift, cc = c + shift, det = aa * cc - b * b;
    if (!(det > 0)) return {};
    t = {(-cc * r.x + b * r.y) / det, (b * r.x - aa * r.y) / det};
    const double length = length_of(t.x, t.y);
    if (length <= radius * (step == 0 ? 1.0 : 1.0 + 1e-12)) {
      if (step == 0) return t;
      break;
    }
    // (A + shift) t = -r; the length falls by t (A + shift)^-1 t / length with the shift.
    const double falls =
        (cc * t.x * t.x - 2 * b * t.x * t.y + aa * t.y * t.y) / (det * length * length);
    shift += (length / radius - 1) / falls;
  }
  const double length = length_of(t.x, t.y);
  return {radius * t.x / length, radius * t.y / length};
}

double symmetric_entry(std::span<const double> W, std::size_t m, std::size_t i, std::size_t j) {
  return i >= j ? W[i * m + j] : W[j * m + i];
}

double own_compliance(const ConeProblem& p, std::size_t i) {
  const std::size_t n = p.q_t.size();
  return std::max(p.W_tt[2 * i * n + 2 * i], p.W_tt[(2 * i + 1) * n + 2 * i + 1]);
}

}  // namespace

void CoulombCone::make_room(std::size_t most) {
  most_ = most;
  for (auto* list : {&q_, &gap_, &best_f_}) list->resize(most);
  for (auto* list : {&b_, &slip_, &best_t_}) list->resize(2 * most);
  const std::size_t unknowns = std::min(kMostUnknowns, 3 * most);
  matrix_.resize(unknowns * unknowns);
  right_.resize(unknowns);
  column_of_.resize(most);
  columns_t_.resize(most);
}

// q_ = q + W_nt t
void CoulombCone::add_friction(const ConeProblem& p, std::span<const double> t) {
  for (std::size_t i = 0; i < p.q.size(); ++i) {
    double sum = p.q[i];
    const float* row = p.W_nt.data() + i * p.wide;
    for (std::size_t j = 0; j < t.size(); ++j) sum += static_cast<double>(row[j]) * t[j];
    q_[i] = sum;
  }
}

// b_ = q_t + W_nt^T f
void CoulombCone::add_pressing(const ConeProblem& p, std::span<const double> f) {
  std::copy(p.q_t.begin(), p.q_t.end(), b_.begin());
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (f[i] == 0) continue;
    const float* row = p.W_nt.data() + i * p.wide;
    for (std::size_t j = 0; j < p.q_t.size(); ++j) b_[j] += static_cast<double>(row[j]) * f[i];
  }
}

// Gauss-Seidel for t with the bounds mu f; slip_ follows.
void CoulombCone::sweep(const ConeProblem& p, std::span<const double> f, std::span<double> t) {
  const std::size_t n = t.size();
  std::copy_n(b_.begin(), n, slip_.begin());
  const auto move = [&](std::size_t component, double by) {
    if (by == 0) return;
    const double* row = p.W_tt.data() + component * n;  // W_tt is symmetric
    for (std::size_t j = 0; j < n; ++j) slip_[j] += by * row[j];
  };
  for (std::size_t j = 0; j < n; ++j) move(j, t[j]);
  for (int count = 0; count < kSweeps; ++count) {
    double largest = 0;
    for (std::size_t i = 0; i < p.contacts.size(); ++i) {
      const std::size_t x = 2 * i, y = x + 1;
      const double a = p.W_tt[x * n + x], b = p.W_tt[x * n + y], c = p.W_tt[y * n + y];
      const DiscPoint without{slip_[x] - a * t[x] - b * t[y], slip_[y] - b * t[x] - c * t[y]};
      const DiscPoint now = minimum_on_disc(a, b, c, without, p.mu[i] * f[p.contacts[i]]);
      const double dx = now.x - t[x], dy = now.y - t[y];
      move(x, dx);
      move(y, dy);
      t[x] = now.x;
      t[y] = now.y;
      largest = std::max(largest, length_of(dx, dy) * std::max(a, c));
    }
    if (largest <= kSweepTolerance * p.tolerance) break;
  }
}

double CoulombCone::residual(const ConeProblem& p, std::span<const double> f,
                             std::span<const double> t) {
  const std::size_t m = p.q.size(), n = t.size();
  add_friction(p, t);
  add_pressing(p, f);
  double largest = 0;
  for (std::size_t i = 0; i < m; ++i) {
    double g = q_[i];
    for (std::size_t j = 0; j < m; ++j) g += symmetric_entry(p.W, m, i, j) * f[j];
    gap_[i] = g;
    largest = std::max(largest, std::abs(std::min(g, p.W[i * m + i] * f[i])));
  }
  for (std::size_t j = 0; j < n; ++j) {
    double s = b_[j];
    for (std::size_t l = 0; l < n; ++l) s += p.W_tt[j * n + l] * t[l];
    slip_[j] = s;
  }
  for (std::size_t i = 0; i < p.contacts.size(); ++i) {
    const double w = own_compliance(p, i), radius = p.mu[i] * std::max(0.0, f[p.contacts[i]]);
    DiscPoint trial{t[2 * i] - slip_[2 * i] / w, t[2 * i + 1] - slip_[2 * i + 1] / w};
    const double length = length_of(trial.x, trial.y);
    if (length > radius) trial = {trial.x * radius / length, trial.y * radius / length};
    largest = std::max(largest, w * length_of(t[2 * i] - trial.x, t[2 * i + 1] - trial.y));
  }
  return largest;
}

ConeOutcome CoulombCone::solve(const ConeProblem& p, Complementarity& normal, std::span<double> f,
                               std::span<double> t) {
  ConeOutcome outcome = solve_by_rounds(p, normal, f, t, 1);
  const auto is_done = [&] { return !outcome.is_solved || outcome.residual <= p.tolerance; };
  if (is_done()) return outcome;
  keep(f, t);
  const ConeOutcome newton = solve_by_newton(p, f, t, kNewtonSteps);
  outcome.newton_steps = newton.newton_steps;
  if (newton.is_solved && newton.residual < outcome.residual) {
    outcome.residual = newton.residual;
  } else {
    take_back(f, t);
  }
  if (is_done()) return outcome;
  keep(f, t);
  const ConeOutcome more = solve_by_rounds(p, normal, f, t, kMostRounds - 1);
  outcome.rounds += more.rounds;
  if (more.is_solved && more.residual < outcome.residual) {
    outcome.residual = more.residual;
  } else {
    take_back(f, t);
  }
  return outcome;
}

void CoulombCone::keep(std::span<const double> f, std::span<const double> t) {
  std::copy(f.begin(), f.end(), best_f_.begin());
  std::copy(t.begin(), t.end(), best_t_.begin());
}

void CoulombCone::take_back(std::span<double> f, std::span<double> t) const {
  std::copy_n(best_f_.begin(), f.size(), f.begin());
  std::copy_n(best_t_.begin(), t.size(), t.begin());
}

ConeOutcome CoulombCone::solve_by_rounds(const ConeProblem& p, Complementarity& normal,
                                         std::span<double> f, std::span<double> t,
                                         int most_rounds) {
  PALPABLE_EXPECT(p.q.size() <= most_ && p.contacts.size() <= most_, "there is room");
  ConeOutcome outcome;
  double before = std::numeric_limits<double>::infinity();
  while (outcome.rounds < most_rounds) {
    add_friction(p, t);
    outcome.is_solved = normal.solve(p.W, std::span<const double>(q_).first(p.q.size()), f);
    if (!outcome.is_solved) break;
    add_pressing(p, f);
    sweep(p, f, t);
    outcome.residual = residual(p, f, t);
    ++outcome.rounds;
    if (outcome.residual <= p.tolerance || outcome.residual > kStalls * before) break;
    before = outcome.residual;
  }
  return outcome;
}

ConeOutcome CoulombCone::solve_by_newton(const ConeProblem& p, std::span<double> f,
                                         std::span<double> t, int most_steps) {
  ConeOutcome outcome;
  outcome.residual = residual(p, f, t);
  outcome.is_solved = true;
  while (outcome.newton_steps < most_steps && outcome.residual > p.tolerance) {
    if (!newton_step(p, f, t)) {
      outcome.is_solved = false;
      break;
    }
    ++outcome.newton_steps;
    outcome.residual = residual(p, f, t);
  }
  // Newton's method may end at a force that pulls by a rounding error.
  for (double& force : f) force = std::max(0.0, force);
  for (std::size_t i = 0; i < p.contacts.size(); ++i) {
    const double radius = p.mu[i] * f[p.contacts[i]];
    const double length = length_of(t[2 * i], t[2 * i + 1]);
    if (!(length > radius)) continue;
    t[2 * i] *= radius / length;
    t[2 * i + 1] *= radius / length;
  }
  outcome.residual = residual(p, f, t);
  return outcome;
}

// row += factor * (derivative of the gap of a contact by the unknowns)
void CoulombCone::fill_row(const ConeProblem& p, std::size_t contact, double factor,
                           double* row) const {
  const std::size_t m = p.q.size();
  for (std::size_t j = 0; j < m; ++j) {
    if (column_of_[j] >= 0) row[column_of_[j]] += factor * symmetric_entry(p.W, m, contact, j);
  }
  for (std::size_t i = 0; i < p.contacts.size(); ++i) {
    if (columns_t_[i] < 0) continue;
    for (std::size_t d = 0; d < 2; ++d) {
      row[static_cast<std::size_t>(columns_t_[i]) + d] +=
          factor * static_cast<double>(p.W_nt[contact * p.wide + 2 * i + d]);
    }
  }
}

// row += factor * (derivative of a component of the slip by the unknowns)
void CoulombCone::fill_slip_row(const ConeProblem& p, std::size_t component, double factor,
                                double* row) const {
  const std::size_t n = p.q_t.size();
  for (std::size_t j = 0; j < p.q.size(); ++j) {
    if (column_of_[j] < 0) continue;
    row[column_of_[j]] += factor * static_cast<double>(p.W_nt[j * p.wide + component]);
  }
  for (std::size_t i = 0; i < p.contacts.size(); ++i) {
    if (columns_t_[i] < 0) continue;
    for (std::size_t d = 0; d < 2; ++d) {
      row[static_cast<std::size_t>(columns_t_[i]) + d] +=
          factor * p.W_tt[component * n + 2 * i + d];
    }
  }
}

// One step of the semismooth Newton method. The unknowns are the forces of the points that are
// closed by f - g / W_ii > 0, and their friction; residual() was called before. With the trial
// force y = t - s / w and e = y / |y| the equations are
//
//     closed   g = 0
//     sticks   s = 0                                         where |y| <= mu f
//     slides   t = mu f e + beta (1 - e e^T) (t - s / w)     elsewhere, beta = mu f / |y| <= 1
bool CoulombCone::newton_step(const ConeProblem& p, std::span<double> f, std::span<double> t) {
  const std::size_t m = p.q.size();
  std::size_t count = 0;
  for (std::size_t i = 0; i < m; ++i) {
    const bool is_closed = f[i] - gap_[i] / p.W[i * m + i] > 0;
    column_of_[i] = is_closed ? static_cast<int>(count++) : -1;
  }
  for (std::size_t i = 0; i < p.contacts.size(); ++i) {
    const bool rubs = column_of_[p.contacts[i]] >= 0 && p.mu[i] > 0;
    columns_t_[i] = rubs ? static_cast<int>(count) : -1;
    if (rubs) count += 2;
  }
  if (count > right_.size()) return false;
  std::fill_n(matrix_.begin(), count * count, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    if (column_of_[i] < 0) continue;
    const auto row = static_cast<std::size_t>(column_of_[i]);
    fill_row(p, i, 1, matrix_.data() + row * count);
    right_[row] = -p.q[i];
  }
  for (std::size_t i = 0; i < p.contacts.size(); ++i) {
    if (columns_t_[i] < 0) continue;
    const auto first = static_cast<std::size_t>(columns_t_[i]);
    const double w = own_compliance(p, i), radius = p.mu[i] * std::max(0.0, f[p.contacts[i]]);
    const DiscPoint trial{t[2 * i] - slip_[2 * i] / w, t[2 * i + 1] - slip_[2 * i + 1] / w};
    const double length = length_of(trial.x, trial.y);
    if (radius > 0 && length <= radius) {
      for (std::size_t d = 0; d < 2; ++d) {
        fill_slip_row(p, 2 * i + d, 1, matrix_.data() + (first + d) * count);
        right_[first + d] = -p.q_t[2 * i + d];
      }
      continue;
    }
    const double e[2] = {length > 0 ? trial.x / length : 0, length > 0 ? trial.y / length : 0};
    const double beta = length > 0 ? radius / length : 0;
    for (std::size_t d = 0; d < 2; ++d) {
      double* row = matrix_.data() + (first + d) * count;
      row[first + d] += 1;
      row[column_of_[p.contacts[i]]] -= p.mu[i] * e[d];
      right_[first + d] = 0;
      for (std::size_t c = 0; c < 2; ++c) {
        const double across = beta * ((c == d ? 1.0 : 0.0) - e[c] * e[d]);
        row[first + c] -= across;
        fill_slip_row(p, 2 * i + c, across / w, row);
        right_[first + d] -= across / w * p.q_t[2 * i + c];
      }
    }
  }
  if (!solve_in_place(matrix_.data(), count, right_.data(), 1)) return false;
  const auto is_finite = [](double x) { return std::isfinite(x); };
  if (!std::all_of(right_.begin(), right_.begin() + static_cast<std::ptrdiff_t>(count), is_finite))
    return false;
  for (std::size_t i = 0; i < m; ++i) {
    f[i] = column_of_[i] >= 0 ? right_[static_cast<std::size_t>(column_of_[i])] : 0;
  }
  for (std::size_t i = 0; i < p.contacts.size(); ++i) {
    for (std::size_t d = 0; d < 2; ++d) {
      t[2 * i + d] = columns_t_[i] >= 0 ? right_[static_cast<std::size_t>(columns_t_[i]) + d] : 0;
    }
  }
  return true;
}

}  // namespace palpable
