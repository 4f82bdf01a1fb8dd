#include "palpable/bake/solid/load_series.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/common/base/error.h"
#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

constexpr double kTop = 0.05;  // m

MatrixXd loads_on(const SolidModel& model, double force) {
  return test::face_loads(model, test::face_nodes(model, kTop, 0.1), force);
}

TEST_CASE("the sum of the orders is the equilibrium that Newton's method finds",
          "[solid][series]") {
  SolidModel model = test::small_beam();
  SECTION("clamped") {}
  SECTION("and half of it, on its plane of symmetry") {
    for (int n = 0; n < model.mesh.node_count(); ++n) {
      if (model.mesh.nodes(1, n) == 0.0 && model.mesh.nodes(0, n) > 0.0) {
        model.supports.push_back({n, {false, true, false}});
      }
    }
  }
  const LoadSeries series(model);
  const MatrixXd loads = loads_on(model, -2.0);
  // The last position is at the tip: bent by a tenth of the length and more.
  const VectorXd f = loads.rightCols(1);
  const LoadOrders orders = series.solve(f, {.most_orders = 20, .tolerance = 1e-9})[0];
  REQUIRE(orders.converged);
  const EquilibriumSolver newton(model, {.tolerance = 1e-10});
  const std::array<double, 2> levels{0.5, 1.0};
  const PathResult path = newton.solve_path(f.reshaped(3, f.size() / 3), levels);
  REQUIRE(path.complete);
  for (std::size_t l = 0; l < levels.size(); ++l) {
    VectorXd u = VectorXd::Zero(f.size());
    for (Index p = orders.u.cols(); p >= 1; --p) u = levels[l] * (u + orders.u.col(p - 1));
    const VectorXd truth = path.steps[l].displacement.reshaped();
    CHECK(truth.cwiseAbs().maxCoeff() > 0.01);
    CHECK((u - truth).norm() <=
          tolerance(1e-7, "Newton's residual over the softest mode") * truth.norm());
  }
}

TEST_CASE("forces balance the load up to the first order left out", "[solid][series]") {
  const SolidModel model = test::small_beam();
  const LoadSeries series(model);
  const VectorXd f = loads_on(model, -2.0).rightCols(1);
  const LoadOrders orders = series.solve(f, {.most_orders = 8, .tolerance = 0.0})[0];
  REQUIRE(orders.u.cols() == 8);
  CHECK_FALSE(orders.converged);
  // The residual of n orders is of order n + 1: for half the load it is 2^(n+1) times smaller.
  for (const Index n : {1, 2, 3, 5}) {
    INFO(n << " orders");
    const auto residual = [&](double a) {
      VectorXd u = VectorXd::Zero(f.size());
      for (Index p = n; p >= 1; --p) u = a * (u + orders.u.col(p - 1));
      return (series.internal_force(u) - a * f).cwiseProduct(series.free_mask()).norm();
    };
    // At a fiftieth of the load, five orders leave only rounding.
    const double a = n == 5 ? 0.2 : 0.02;
    const double order = std::log2(residual(a) / residual(a / 2.0));
    CHECK(std::abs(order - static_cast<double>(n + 1)) <=
          tolerance(0.1, "the next order, a twentieth of this one or less"));
  }
}

TEST_CASE("what comes out for a load does not depend on its neighbours", "[solid][series]") {
  const SolidModel model = test::small_beam(8, 2, 1);
  const LoadSeries series(model);
  const MatrixXd loads = loads_on(model, -1.0);
  REQUIRE(loads.cols() > 16);  // more than are solved side by side
  const std::vector<LoadOrders> all = series.solve(loads, {.most_orders = 6, .tolerance = 1e-3});
  REQUIRE(all.size() == static_cast<std::size_t>(loads.cols()));
  for (const Index s : {Index{0}, Index{11}, Index{17}, loads.cols() - 1}) {
    const LoadOrders alone = series.solve(loads.col(s), {.most_orders = 6, .tolerance = 1e-3})[0];
    const LoadOrders& together = all[s];
    REQUIRE(alone.u.cols() == together.u.cols());
    CHECK(alone.converged == together.converged);
    CHECK((alone.u - together.u).norm() <=
          tolerance(1e-11, "BLAS sums in another order") * alone.u.norm());
    CHECK((series.linear_response(loads.col(s)) - alone.u.col(0)).norm() <=
          tolerance(1e-11, "likewise") * alone.u.col(0).norm());
  }
}

TEST_CASE("the linear response is what the stiffness makes of the load", "[solid][series]") {
  const SolidModel model = test::small_beam(8, 2, 1);
  const LoadSeries series(model);
  const VectorXd f = loads_on(model, -1.0).col(3);
  const VectorXd back = series.stiffness_times(series.linear_response(f));
  CHECK((back - f).cwiseProduct(series.free_mask()).norm() <=
        tolerance(1e-10, "rounding of a slender beam's factor") * f.norm());
}

TEST_CASE("the Pade form sums what the series no longer can", "[solid][series]") {
  // u = a v / (1 + 3 a): the series ends at a = 1/3, the Pade form of two orders is u itself.
  MatrixXd gram(2, 2);
  gram << 1, -3, -3, 9;
  for (const double a : {0.1, 1.0, 7.0}) {
    const VectorXd c = pade_coefficients(gram, a);
    CHECK(c[0] - 3.0 * c[1] == Approx(a / (1.0 + 3.0 * a)).epsilon(1e-12));
  }
  CHECK(pade_coefficients(MatrixXd::Ones(1, 1), 0.4)[0] == 0.4);

  // On a beam both agree where the series converges.
  const SolidModel model = test::small_beam();
  const LoadSeries series(model);
  const VectorXd f = loads_on(model, -2.0).rightCols(1);
  const LoadOrders orders = series.solve(f, {.most_orders = 20, .tolerance = 1e-7})[0];
  const VectorXd u = orders.u.rowwise().sum();
  const VectorXd pade =
      orders.u *
      pade_coefficients(orders.u.transpose() * series.mass().asDiagonal() * orders.u, 1.0);
  CHECK((pade - u).norm() <= tolerance(1e-6, "the last order is 1e-7 of the first") * u.norm());
}

TEST_CASE("bodies that have no such series are refused", "[solid][series]") {
  SolidModel model = test::small_beam(4, 2, 1);
  SECTION("another law") {
    model.material = material_from_young("neo-hookean", 1e5, 0.3);
    CHECK_THROWS_WITH(LoadSeries(model), Contains("saint-venant-kirchhoff") && Contains("neo-"));
  }
  SECTION("ten nodes") {
    model.mesh = with_edge_nodes(model.mesh);
    CHECK_THROWS_WITH(LoadSeries(model), Contains("4-node"));
  }
  SECTION("supports that move") {
    model.supports.push_back({0, {true, true, true}, {0.01, 0, 0}});
    model.fixed_nodes.erase(model.fixed_nodes.begin());
    CHECK_THROWS_WITH(LoadSeries(model), Contains("stand still"));
  }
}

}  // namespace
}  // namespace palpable
