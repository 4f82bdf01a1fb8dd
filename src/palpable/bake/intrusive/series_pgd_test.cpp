#include "palpable/bake/intrusive/series_pgd.h"

#include "palpable/common/base/error.h"
#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

struct Beam {
  SolidModel model = test::small_beam(16, 4, 2);
  LoadSeries body{model};
  Eigen::SparseMatrix<double> load =
      test::face_loads(model, test::face_nodes(model, 0.05, 0.05), -2.0);
  VectorXd area = VectorXd::LinSpaced(load.cols(), 1.0, 2.0);
  VectorXd levels = VectorXd::LinSpaced(6, 1.0 / 6.0, 1.0);
  SeriesTable table = solve_series(body, load, area, levels, {}, {}, {}, ResidualsAt::kAllLevels);
};

const Beam& beam() {
  static const Beam one;
  return one;
}

// (3N x J) the full fields of one position, by a series of its own.
MatrixXd fields(const Beam& beam, Index s) {
  const LoadOrders orders =
      beam.body.solve(MatrixXd(beam.load.col(s)), {.most_orders = 25, .tolerance = 1e-10})[0];
  MatrixXd u = MatrixXd::Zero(beam.load.rows(), beam.levels.size());
  for (Index j = 0; j < u.cols(); ++j) {
    for (Index p = orders.u.cols(); p >= 1; --p) {
      u.col(j) = beam.levels[j] * (u.col(j) + orders.u.col(p - 1));
    }
  }
  return u;
}

TEST_CASE("the table's fields are in equilibrium, and Pade's form agrees with the series",
          "[intrusive]") {
  const VectorXd& residual = beam().table.worst_residual;
  REQUIRE(residual.size() == 6);
  CHECK(residual.maxCoeff() <= tolerance(2e-6, "orders end at 1.5e-7 of the first"));
  CHECK(residual.minCoeff() > 0.0);
  // The truncation error falls faster than the load.
  CHECK(residual[0] < residual[5]);
  CHECK(beam().table.worst_pade_gap <= tolerance(1e-6, "likewise"));
  CHECK(beam().table.worst_pade_gap > 0.0);
  CHECK(beam().table.most_orders >= 8);  // a beam that bends by 15 % of its length
}

TEST_CASE("nonlinear: greedy modes are nearly those of the SVD, recompressed they are",
          "[intrusive]") {
  const Beam& b = beam();
  for (const SeriesWeight weight : {SeriesWeight::kPlain, SeriesWeight::kOwnNorm}) {
    INFO((weight == SeriesWeight::kPlain ? "plain" : "own norms"));
    const SeriesPgdGoal goal{.weight = weight, .modes = 24};
    const SeriesPgd pgd = series_pgd(b.body, b.table, goal);
    // For comparison, the SVD of the fields themselves, each times the root of its weight.
    MatrixXd all(b.load.rows(), b.load.cols() * b.levels.size());
    for (Index s = 0; s < b.load.cols(); ++s) {
      MatrixXd u = fields(b, s);
      const VectorXd first = b.body.linear_response(VectorXd(b.load.col(s)));
      const double own = first.dot(b.body.mass().cwiseProduct(first));
      for (Index j = 0; j < b.levels.size(); ++j) {
        u.col(j) *= std::sqrt(b.area[s]);
        if (weight == SeriesWeight::kOwnNorm) u.col(j) /= b.levels[j] * std::sqrt(own);
      }
      all.middleCols(s * b.levels.size(), b.levels.size()) = u;
    }
    all = b.body.mass().cwiseSqrt().asDiagonal() * all;
    const VectorXd squares =
        Eigen::SelfAdjointEigenSolver<MatrixXd>(all.transpose() * all).eigenvalues().reverse();
    const SeriesPgd best = recompressed(pgd, b.table, goal, 24);
    double left = squares.sum();
    for (Index m = 0; m < 16; ++m) {
      INFO(m + 1 << " modes");
      left -= squares[m];
      const double svd = std::sqrt(left / squares.sum());
      CHECK(pgd.errors[m] >= svd * (1.0 - 1e-3));
      CHECK(best.errors[m] >= svd * (1.0 - 1e-3));
      CHECK(best.errors[m] <=
            svd * (1.0 + tolerance(0.02, "24 greedy modes span the first 16 nearly")));
      // Greedy modes are not the best ones, but never worse than an SVD with two modes fewer.
      if (m >= 2) {
        const double two_before = std::sqrt((left + squares[m] + squares[m - 1]) / squares.sum());
        CHECK(pgd.errors[m] <= two_before);
      }
    }
  }
}

TEST_CASE("the modes are orthonormal in the body's mass", "[intrusive]") {
  const Beam& b = beam();
  const SeriesPgd pgd = series_pgd(b.body, b.table, {.modes = 8});
  const MatrixXd unit = pgd.F.transpose() * b.body.mass().asDiagonal() * pgd.F;
  CHECK((unit - MatrixXd::Identity(8, 8)).norm() <= tolerance(1e-10, "rounding"));
}

TEST_CASE("positions that are left out are not looked at", "[intrusive]") {
  const Beam& b = beam();
  SeriesPgdGoal goal{.modes = 4};
  goal.used.assign(b.load.cols(), 1);
  goal.used[3] = 0;
  const SeriesPgd pgd = series_pgd(b.body, b.table, goal);
  CHECK(pgd.G[3].isZero(0.0));
  CHECK(pgd.G[4].row(0).norm() > 0.0);
}

TEST_CASE("a load beyond the range of the series is refused, with its place", "[intrusive]") {
  const Beam& b = beam();
  CHECK_THROWS_WITH(solve_series(b.body, 5.0 * b.load, b.area, b.levels),
                    Contains("10 N") && Contains("beyond the range"));
}

}  // namespace

}  // namespace palpable
