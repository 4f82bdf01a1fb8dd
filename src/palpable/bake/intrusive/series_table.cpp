#include "palpable/bake/intrusive/series_table.h"

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

}  // namespace palpable
