#include "palpable/bake/intrusive/series_pgd.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// (S) of (n_s x n_s): omega_s W(s); empty for a position that is not used.
std::vector<MatrixXd> weights_of(const SeriesTable& table, const SeriesPgdGoal& goal) {
  std::vector<MatrixXd> weights(table.positions());
  for (std::size_t s = 0; s < weights.size(); ++s) {
    if (!goal.used.empty() && goal.used[s] == 0) continue;
    const MatrixXd& c = table.at_level[s];
    VectorXd of_level = VectorXd::Constant(c.cols(), table.area[static_cast<Index>(s)]);
    if (goal.weight == SeriesWeight::kOwnNorm) {
      of_level = of_level.cwiseQuotient(table.gram[s](0, 0) * table.levels.cwiseAbs2());
    }
    weights[s] = c * of_level.asDiagonal() * c.transpose();
  }
  return weights;
}

double trace_of_product(const MatrixXd& A, const MatrixXd& B) { return A.cwiseProduct(B).sum(); }

// (S) of (k x n_s): F_i . M u_p(s) of k fields, by the adjoint for p = 1; of the positions in
// `wanted`, empty elsewhere.
std::vector<MatrixXd> position_step(const LoadSeries& body, const SeriesTable& table,
                                    const std::vector<char>& wanted, const MatrixXd& F) {
  const MatrixXd MF = body.mass().asDiagonal() * F;
  const Eigen::MatrixXf MF_single = MF.cast<float>();
  const MatrixXd first_orders = table.load.transpose() * body.linear_response(MF);  // (S x k)
  std::vector<MatrixXd> g(table.higher.size());
  for (std::size_t s = 0; s < g.size(); ++s) {
    if (wanted[s] == 0) continue;
    const Eigen::MatrixXf& higher = table.higher[s];
    g[s].resize(F.cols(), higher.cols() + 1);
    g[s].col(0) = first_orders.row(static_cast<Index>(s)).transpose();
    // Single precision, 38,000 terms: 1e-6 of a value, far below any mode that is asked for.
    g[s].rightCols(higher.cols()) = (MF_single.transpose() * higher).cast<double>();
  }
  return g;
}

// (3N x k) sum_s omega_s sum_{p,q} g_p(s) W_pq(s) u_q(s), by a solve for q = 1. The previous
// modes are not subtracted.
MatrixXd space_step(const LoadSeries& body, const SeriesTable& table,
                    const std::vector<MatrixXd>& weights, const std::vector<MatrixXd>& g) {
  const Index k = std::find_if(g.begin(), g.end(), [](const MatrixXd& here) {
                    return here.size() > 0;
                  })->rows();
  MatrixXd F = MatrixXd::Zero(table.load.rows(), k);
  MatrixXd of_load = MatrixXd::Zero(table.positions(), k);
  for (std::size_t s = 0; s < weights.size(); ++s) {
    if (weights[s].size() == 0) continue;
    const MatrixXd v = weights[s] * g[s].transpose();  // (n_s x k)
    of_load.row(static_cast<Index>(s)) = v.row(0);
    F += (table.higher[s] * v.bottomRows(v.rows() - 1).cast<float>()).cast<double>();
  }
  return F + body.linear_response(MatrixXd(table.load * of_load));
}

std::vector<char> used_in(const std::vector<MatrixXd>& weights) {
  std::vector<char> used;
  for (const MatrixXd& weight : weights) used.push_back(weight.size() > 0 ? 1 : 0);
  return used;
}

// In place: normal to the columns of Q (twice, for rounding) and of unit length, in M.
// @returns the length that was left
double make_normal(const VectorXd& M, const Eigen::Ref<const MatrixXd>& Q, VectorXd& F) {
  for (int again = 0; again < 2; ++again) F -= Q * (Q.transpose() * M.cwiseProduct(F));
  const double length = std::sqrt(F.dot(M.cwiseProduct(F)));
  F /= length;
  return length;
}

// The remainder of the field of one position at the full load, after its modes.
VectorXd left_over(const LoadSeries& body, const SeriesTable& table, const MatrixXd& F,
                   const MatrixXd& G, std::size_t s) {
  const VectorXd c = table.at_level[s].rightCols(1);
  const VectorXd f = table.load.col(static_cast<Index>(s));
  VectorXd u = c[0] * body.linear_response(f);
  u += (table.higher[s] * c.tail(c.size() - 1).cast<float>()).cast<double>();
  return u - F * (G * c);
}

}  // namespace

SeriesPgd series_pgd(const LoadSeries& body, const SeriesTable& table, const SeriesPgdGoal& goal,
                     const Progress& progress) {
  PALPABLE_EXPECT(goal.modes >= 1, "at least one mode");
  PALPABLE_EXPECT(goal.used.empty() || goal.used.size() == table.gram.size(), "a flag each");
  const VectorXd& M = body.mass();
  const std::vector<MatrixXd> weights = weights_of(table, goal);
  const std::vector<char> used = used_in(weights);
  const std::size_t S = weights.size();
  SeriesPgd pgd{MatrixXd(table.load.rows(), goal.modes), std::vector<MatrixXd>(S),
                VectorXd(goal.modes)};
  std::vector<MatrixXd> left = table.gram;  // inner products of the remainders of the orders
  double whole = 0.0;
  for (std::size_t s = 0; s < S; ++s) {
    pgd.G[s] = MatrixXd::Zero(goal.modes, table.gram[s].rows());
    if (weights[s].size() > 0) whole += trace_of_product(weights[s], table.gram[s]);
  }
  Index m = 0;
  for (; m < goal.modes; ++m) {
    // Start at the remainder of the position with the largest error. It is close to the next mode:
    // two or three turns suffice instead of five.
    std::size_t worst = 0;
    double most = -1.0;
    for (std::size_t s = 0; s < S; ++s) {
      if (weights[s].size() == 0) continue;
      const double here = trace_of_product(weights[s], left[s]);
      if (here > most) most = here, worst = s;
    }
    VectorXd F = left_over(body, table, pgd.F.leftCols(m), pgd.G[worst].topRows(m), worst);
    make_normal(M, pgd.F.leftCols(m), F);
    std::vector<MatrixXd> g;
    constexpr int kMostTurns = 6;
    for (int turns = 1; turns <= kMostTurns; ++turns) {
      g = position_step(body, table, used, F);
      VectorXd next = space_step(body, table, weights, g);
      ++pgd.alternations;
      make_normal(M, pgd.F.leftCols(m), next);
      // Sine of the angle by which another turn would rotate the mode. What remains is not lost:
      // the next mode begins with it.
      const double along = std::min(1.0, std::abs(next.dot(M.cwiseProduct(F))));
      if (turns == kMostTurns || std::sqrt(1.0 - along * along) < 0.1) break;
      F = std::move(next);
    }
    pgd.F.col(m) = F;
    double sum = 0.0;
    for (std::size_t s = 0; s < S; ++s) {
      if (weights[s].size() == 0) continue;
      pgd.G[s].row(m) = g[s];
      left[s] -= g[s].transpose() * g[s];
      sum += trace_of_product(weights[s], left[s]);
    }
    pgd.errors[m] = std::sqrt(std::max(0.0, sum / whole));
    report(progress, {"separating", static_cast<double>(m + 1), static_cast<double>(goal.modes),
                      fmt::format("{} modes, error {:.2e}", m + 1, pgd.errors[m])});
    if (pgd.errors[m] <= goal.tolerance) {
      ++m;
      break;
    }
  }
  pgd.F.conservativeResize(Eigen::NoChange, m);
  pgd.errors.conservativeResize(m);
  for (MatrixXd& G : pgd.G) G.conservativeResize(m, Eigen::NoChange);
  return pgd;
}

SeriesPgd recompressed(const SeriesPgd& pgd, const SeriesTable& table, const SeriesPgdGoal& goal,
                       int modes) {
  const Index m = pgd.F.cols();
  PALPABLE_EXPECT(1 <= modes && modes <= m, "as many modes as there are, at most");
  const std::vector<MatrixXd> weights = weights_of(table, goal);
  MatrixXd moment = MatrixXd::Zero(m, m);
  double whole = 0.0;
  for (std::size_t s = 0; s < weights.size(); ++s) {
    if (weights[s].size() == 0) continue;
    moment += pgd.G[s] * weights[s] * pgd.G[s].transpose();
    whole += trace_of_product(weights[s], table.gram[s]);
  }
  const SymmetricEigen eigen = symmetric_eigen(moment);  // increasing
  const MatrixXd V = eigen.vectors.rightCols(modes).rowwise().reverse();
  SeriesPgd best{times(pgd.F, V), {}, VectorXd(modes), pgd.alternations};
  for (const MatrixXd& G : pgd.G) best.G.emplace_back(V.transpose() * G);
  double found = 0.0;
  for (Index k = 0; k < modes; ++k) {
    found += eigen.values[m - 1 - k];
    best.errors[k] = std::sqrt(std::max(0.0, 1.0 - found / whole));
  }
  return best;
}

SeriesPgd svd_of_series(const LoadSeries& body, const SeriesTable& table, const SeriesPgdGoal& goal,
                        const Progress& progress) {
  const std::vector<MatrixXd> weights = weights_of(table, goal);
  const std::vector<char> used = used_in(weights);
  // A third more vectors than asked for, and six turns: an error of the modes' values below
  // (s_{4m/3} / s_m)^12.
  constexpr int kTurns = 6;
  const Index k = goal.modes + goal.modes / 3 + 4;
  const VectorXd root = body.mass().cwiseSqrt();
  SeriesPgd svd;
  {
    // Any loads: those of every S/k-th position.
    MatrixXd f(table.load.rows(), k);
    for (Index i = 0; i < k; ++i) f.col(i) = table.load.col(i * table.positions() / k);
    svd.F = body.linear_response(f);
  }
  for (int turn = 1; turn <= kTurns; ++turn) {
    svd.F = root.cwiseInverse().asDiagonal() * orthonormal_basis(root.asDiagonal() * svd.F);
    svd.G = position_step(body, table, used, svd.F);
    if (turn < kTurns) svd.F = space_step(body, table, weights, svd.G);
    report(progress, {"singular value decomposition", static_cast<double>(turn), kTurns, ""});
  }
  for (std::size_t s = 0; s < svd.G.size(); ++s) {
    if (used[s] == 0) svd.G[s] = MatrixXd::Zero(k, table.gram[s].rows());
  }
  return recompressed(svd, table, goal, goal.modes);
}

std::vector<MatrixXd> coordinates_of(const LoadSeries& body, const SeriesTable& table,
                                     const MatrixXd& F) {
  return position_step(body, table, std::vector<char>(table.gram.size(), 1), F);
}

}  // namespace palpable
