#include "bench/bake/beam_study.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/error.h"
#include "palpable/common/reduced/spline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Groups the positions by Y; each group is sorted by X.
std::vector<std::vector<Index>> rows_of(const TravellingLoad& travelling) {
  const Eigen::Matrix3Xd& X = travelling.problem.mesh.boundary.surface.vertices;
  std::map<long long, std::vector<Index>> rows;
  for (std::size_t s = 0; s < travelling.problem.sites.size(); ++s) {
    // Y is rounded to a thousandth of the patch radius.
    const double y = X(1, travelling.problem.sites[s].vertex);
    rows[std::llround(1e3 * y / travelling.patch_radius)].push_back(static_cast<Index>(s));
  }
  std::vector<std::vector<Index>> sorted;
  for (auto& [y, row] : rows) {
    std::sort(row.begin(), row.end(), [&](Index a, Index b) {
      const auto x = [&](Index s) { return X(0, travelling.problem.sites[s].vertex); };
      return x(a) < x(b);
    });
    sorted.push_back(std::move(row));
  }
  return sorted;
}

}  // namespace

HeldOutPositions held_out_positions(const LoadSeries& body, const TravellingLoad& travelling,
                                    const SeriesTable& table, int modes, const Progress& progress) {
  const std::vector<std::vector<Index>> rows = rows_of(travelling);
  SeriesPgdGoal goal{.modes = modes};
  goal.used.assign(table.gram.size(), 1);
  for (const std::vector<Index>& row : rows) {
    for (std::size_t k = 1; k + 1 < row.size(); k += 2) { goal.used[row[k]] = 0; }
  }
  HeldOutPositions result;
  result.trained_on = static_cast<int>(std::count(goal.used.begin(), goal.used.end(), 1));
  result.held_out = static_cast<int>(goal.used.size()) - result.trained_on;
  const SeriesPgd pgd = series_pgd(body, table, goal, progress);
  result.modes = static_cast<int>(pgd.F.cols());
  const std::vector<MatrixXd> true_G = coordinates_of(body, table, pgd.F);

  const Eigen::Matrix3Xd& X = travelling.problem.mesh.boundary.surface.vertices;
  const Index J = table.levels.size(), m = pgd.F.cols();
  double sum = 0.0, whole = 0.0;
  for (const std::vector<Index>& row : rows) {
    std::vector<Index> known;
    for (const Index s : row) {
      if (goal.used[s] != 0) known.push_back(s);
    }
    const auto x = [&](Index s) { return X(0, travelling.problem.sites[s].vertex); };
    VectorXd at(static_cast<Index>(known.size()));
    MatrixXd values(at.size(), m * J);
    for (Index k = 0; k < at.size(); ++k) {
      const auto s = static_cast<std::size_t>(known[k]);
      at[k] = x(known[k]);
      values.row(k) = (pgd.G[s] * table.at_level[s]).reshaped().transpose();
    }
    const MatrixXd slopes = spline_slopes(at, values);
    for (const Index position : row) {
      const auto s = static_cast<std::size_t>(position);
      if (goal.used[s] != 0) continue;
      const CubicWeights w = cubic_weights(at, x(position));
      const MatrixXd guess = (w.value[0] * values.row(w.left) + w.value[1] * slopes.row(w.left) +
                              w.value[2] * values.row(w.right) + w.value[3] * slopes.row(w.right))
                                 .reshaped(m, J);
      const MatrixXd best = true_G[s] * table.at_level[s];
      for (Index j = 0; j < J; ++j) {
        const VectorXd c = table.at_level[s].col(j);
        const double norm = c.dot(table.gram[s] * c);
        const double square = std::max(0.0, norm - best.col(j).squaredNorm()) +
                              (best.col(j) - guess.col(j)).squaredNorm();
        sum += table.area[position] * square;
        whole += table.area[position] * norm;
        result.worst = std::max(result.worst, std::sqrt(square / norm));
      }
    }
  }
  result.global = whole > 0.0 ? std::sqrt(sum / whole) : 0.0;
  return result;
}

double linear_model_error(const SeriesTable& table) {
  double worst = 0.0;
  for (std::size_t s = 0; s < table.gram.size(); ++s) {
    for (Index j = 0; j < table.levels.size(); ++j) {
      const VectorXd c = table.at_level[s].col(j);
      VectorXd gone = c;
      gone[0] -= table.levels[j];
      worst = std::max(worst, std::sqrt(gone.dot(table.gram[s] * gone) / c.dot(table.gram[s] * c)));
    }
  }
  return worst;
}

BodyDifference body_difference(const ReducedBody& body, const ReducedBody& other) {
  const Index V = body.surface.vertices.cols();
  if (other.surface.vertices.cols() != V ||
      (other.surface.vertices - body.surface.vertices).cwiseAbs().maxCoeff() > 1e-6) {
    throw Error(fmt::format("'{}' and '{}' have different skins: bake both from one mesh",
                            body.name, other.name));
  }
  const VectorXd areas = vertex_areas(body.surface);
  struct Sums {
    std::vector<double> own;
    double gone = 0, whole = 0;
  };
  const auto add = [&](Sums& sums, const SeparatedField& of_body, const SeparatedField& of_other,
                       const std::array<double, 2>& mu, const std::array<double, 2>& nu) {
    std::vector<float> a(of_body.value_count()), b(a.size());
    of_body.evaluate(mu, a);
    of_other.evaluate(nu, b);
    const std::size_t components = a.size() / static_cast<std::size_t>(V);
    double gone = 0, whole = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      // Shear components count twice in the tensor's norm.
      const double weight =
          areas[static_cast<Index>(k / components)] * (components == 6 && k % 6 >= 3 ? 2.0 : 1.0);
      const double truth = static_cast<double>(b[k]);
      gone += weight * (static_cast<double>(a[k]) - truth) * (static_cast<double>(a[k]) - truth);
      whole += weight * truth * truth;
    }
    sums.own.push_back(std::sqrt(gone / whole));
    sums.gone += gone;
    sums.whole += whole;
  };
  BodyDifference difference;
  Sums u, sigma;
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    for (std::size_t t = 0; t < other.sites.size(); ++t) {
      if (body.sites[s].vertex != other.sites[t].vertex) continue;
      ++difference.shared;
      const double force = std::min(body.sites[s].full_load, other.sites[t].full_load);
      for (const double part : {0.5, 1.0}) {
        const std::array<double, 2> mu{static_cast<double>(s),
                                       part * force / body.sites[s].full_load},
            nu{static_cast<double>(t), part * force / other.sites[t].full_load};
        add(u, body.displacement, other.displacement, mu, nu);
        add(sigma, body.stress, other.stress, mu, nu);
      }
    }
  }
  if (difference.shared == 0) {
    throw Error(fmt::format("'{}' and '{}' share no site", body.name, other.name));
  }
  for (Sums* sums : {&u, &sigma}) std::sort(sums->own.begin(), sums->own.end());
  difference.displacement_pooled = std::sqrt(u.gone / u.whole);
  difference.displacement_median = u.own[u.own.size() / 2];
  difference.displacement_worst = u.own.back();
  difference.stress_pooled = std::sqrt(sigma.gone / sigma.whole);
  difference.stress_median = sigma.own[sigma.own.size() / 2];
  difference.stress_worst = sigma.own.back();
  return difference;
}

std::vector<NewtonCheck> newton_checks(const IntrusiveBake& made, int count, unsigned seed,
                                       const Progress& progress) {
  std::mt19937_64 random(seed);
  const SolidModel& model = made.series.model();
  const EquilibriumSolver newton(model);
  const StressRecovery recovery(model.mesh);
  const Boundary& boundary = made.travelling.problem.mesh.boundary;
  const VectorXd areas = vertex_areas(boundary.surface);
  const auto V = static_cast<Index>(areas.size());
  std::vector<float> u(3 * V), sigma(6 * V);
  std::vector<NewtonCheck> checks;
  for (int k = 0; k < count; ++k) {
    // 53 random bits: the same number on every system.
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    NewtonCheck check;
    check.site = static_cast<int>(uniform() * static_cast<double>(made.body.sites.size()));
    check.level = 0.05 + 0.95 * uniform();
    const VectorXd f = made.travelling.load.col(check.site);
    const PathResult path =
        newton.solve_path(f.reshaped(3, f.size() / 3), std::array<double, 1>{check.level});
    if (!path.complete) throw Error("a reference was not found: " + path.why_stopped);
    const Eigen::Matrix3Xd truth = path.steps[0].displacement(Eigen::all, boundary.node_of_vertex);
    const StressField stress = nodal_cauchy_stress(model, path.steps[0].displacement, recovery)(
        Eigen::all, boundary.node_of_vertex);
    const std::array<double, 2> mu{static_cast<double>(check.site), check.level};
    made.body.displacement.evaluate(mu, u);
    made.body.stress.evaluate(mu, sigma);
    const MatrixXd gone = Eigen::Map<const Eigen::Matrix3Xf>(u.data(), 3, V).cast<double>() - truth;
    const MatrixXd gone_stress =
        Eigen::Map<const Eigen::Matrix<float, 6, Eigen::Dynamic>>(sigma.data(), 6, V)
            .cast<double>() -
        stress;
    const auto norm = [&](const MatrixXd& field) {
      VectorXd rows = field.cwiseAbs2() * areas;
      if (rows.size() == 6) rows.tail<3>() *= 2.0;  // shear components count twice
      return std::sqrt(rows.sum());
    };
    check.deflection = truth.colwise().norm().maxCoeff();
    check.displacement = norm(gone) / norm(truth);
    check.stress = norm(gone_stress) / norm(stress);
    checks.push_back(check);
    report(progress, {"fresh Newton solves", k + 1.0, static_cast<double>(count), ""});
  }
  return checks;
}

}  // namespace palpable
