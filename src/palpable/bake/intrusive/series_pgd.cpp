#include "palpable/bake/intrusive/series_pgd.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Point of application of the force of position s, m: the mean of the nodes that carry it.
Eigen::Vector3d middle(const Eigen::SparseMatrix<double>& load, Index s,
                       const Eigen::Matrix3Xd& nodes) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0.0;
  for (Eigen::SparseMatrix<double>::InnerIterator entry(load, s); entry; ++entry) {
    sum += std::abs(entry.value()) * nodes.col(entry.row() / 3);
    weight += std::abs(entry.value());
  }
  return sum / weight;
}

// The positions in increasing distance from the centre of the held nodes.
std::vector<Index> by_distance(const LoadSeries& body, const Eigen::SparseMatrix<double>& load) {
  const Eigen::Matrix3Xd& nodes = body.model().mesh.nodes;
  Eigen::Vector3d held = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (Index n = 0; n < nodes.cols(); ++n) {
    if (body.free_mask().segment<3>(3 * n).sum() > 0.0) continue;
    held += nodes.col(n);
    count += 1.0;
  }
  held /= std::max(count, 1.0);
  VectorXd distance(load.cols());
  for (Index s = 0; s < load.cols(); ++s) distance[s] = (middle(load, s, nodes) - held).norm();
  std::vector<Index> order(load.cols());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return distance[a] < distance[b]; });
  return order;
}

// (n x J) coefficients of the orders at each level.
MatrixXd coefficients(const MatrixXd& gram, const VectorXd& levels) {
  constexpr Index kPadeFrom = 6;
  const Index n = gram.rows();
  MatrixXd c(n, levels.size());
  for (Index j = 0; j < levels.size(); ++j) {
    for (Index p = 1; p <= n; ++p) c(p - 1, j) = std::pow(levels[j], static_cast<double>(p));
    if (n >= kPadeFrom) c.col(j) = pade_coefficients(gram, levels[j]);
  }
  return c;
}

}  // namespace

SeriesTable solve_series(const LoadSeries& body, const Eigen::SparseMatrix<double>& load,
                         const VectorXd& area, const VectorXd& levels, const VectorXd& shown,
                         const SeriesVisit& visit, const Progress& progress,
                         ResidualsAt residuals) {
  PALPABLE_EXPECT(area.size() == load.cols() && area.minCoeff() > 0.0, "an area > 0 each");
  PALPABLE_EXPECT(levels.size() > 0 && levels[levels.size() - 1] == 1.0, "levels end at 1");
  // 1.5e-7 of |u_1| leaves residual forces within 1e-6 of the load. That needs the Pade form from 6
  // orders on; below, one order more or less changes the residual by a factor of 20.
  const SeriesSettings settings{.most_orders = 20, .tolerance = 1.5e-7};
  const auto S = static_cast<std::size_t>(load.cols());
  SeriesTable table{.load = load,
                    .area = area,
                    .higher = std::vector<Eigen::MatrixXf>(S),
                    .gram = std::vector<MatrixXd>(S),
                    .at_level = std::vector<MatrixXd>(S),
                    .work = std::vector<VectorXd>(S),
                    .levels = levels};
  const Index J = levels.size(), checked = residuals == ResidualsAt::kAllLevels ? J : 1;
  table.worst_residual = VectorXd::Zero(checked);
  const std::vector<Index> order = by_distance(body, load);
  constexpr std::size_t kBatch = 16;
  for (std::size_t first = 0; first < S; first += kBatch) {
    const std::size_t count = std::min(kBatch, S - first);
    MatrixXd f(load.rows(), static_cast<Index>(count));
    for (std::size_t k = 0; k < count; ++k)
      f.col(static_cast<Index>(k)) = load.col(order[first + k]);
    const std::vector<LoadOrders> solved = body.solve(f, settings);
    for (std::size_t k = 0; k < count; ++k) {
      const Index s = order[first + k];
      const LoadOrders& series = solved[k];
      if (!series.converged) {
        const Eigen::Vector3d X = middle(load, s, body.model().mesh.nodes);
        const VectorXd f_s = f.col(static_cast<Index>(k));
        throw Error(fmt::format(
            "the load of {:.4g} N at ({:.4g}, {:.4g}, {:.4g}) m is beyond the range of the power "
            "series, which bears about {:.2g} times that there and should bear 2; ask for less",
            f_s.reshaped(3, f_s.size() / 3).rowwise().sum().norm(), X[0], X[1], X[2],
            series.radius));
      }
      const auto at = static_cast<std::size_t>(s);
      const Index n = series.u.cols();
      MatrixXd& gram = table.gram[at];
      gram = series.u.transpose() * body.mass().asDiagonal() * series.u;
      table.higher[at] = series.u.rightCols(n - 1).cast<float>();
      MatrixXd& c = table.at_level[at];
      c = coefficients(gram, levels);
      const VectorXd sum = VectorXd::Ones(n);  // the series at the full load
      const VectorXd gap = pade_coefficients(gram, 1.0) - sum;
      table.worst_pade_gap =
          std::max(table.worst_pade_gap,
                   std::sqrt(std::max(0.0, gap.dot(gram * gap)) / sum.dot(gram * sum)));
      const VectorXd f_s = f.col(static_cast<Index>(k));
      table.work[at] = series.u.transpose() * f_s;
      if (visit) visit(s, series.u * coefficients(gram, shown));
      const auto residual_at = [&](Index j) {
        const VectorXd u = series.u * c.col(j), load_now = levels[j] * f_s;
        const VectorXd left = (body.internal_force(u) - load_now).cwiseProduct(body.free_mask());
        double& worst = table.worst_residual[checked - (J - j)];
        worst = std::max(worst, left.norm() / load_now.norm());
      };
      residual_at(J - 1);
      const double begin = thread_cpu_seconds();
      for (Index j = J - checked; j + 1 < J; ++j) residual_at(j);
      table.check_cpu_s += thread_cpu_seconds() - begin;
      table.orders += static_cast<int>(n);
      table.most_orders = std::max(table.most_orders, static_cast<int>(n));
    }
    report(progress, {"power series", static_cast<double>(first + count), static_cast<double>(S),
                      fmt::format("{} orders at most", table.most_orders)});
  }
  return table;
}

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
