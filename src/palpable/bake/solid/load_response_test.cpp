#include "palpable/bake/solid/load_response.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/load_series.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <string>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;
using test::tolerance;

// 60 x 40 x 50 mm of rubber, held below.
SolidModel block(const std::string& law) {
  SolidModel model;
  model.mesh = box_tets({-0.03, -0.02, 0}, {0.03, 0.02, 0.05}, 4, 3, 4);
  model.material = material_from_young(law, 60e3, 0.4);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
  }
  return model;
}

// A field that is 0 where the body is held; gradients of a few per cent.
VectorXd some_field(const LoadResponse& response, unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<double> entry(0.0, 1e-4);
  const VectorXd u =
      VectorXd::NullaryExpr(response.free_mask().size(), [&] { return entry(random); });
  return u.cwiseProduct(response.free_mask());
}

VectorXd internal_force(const EquilibriumSolver& solver, const VectorXd& u) {
  return solver.internal_force(u.reshaped(3, u.size() / 3)).reshaped();
}

// Coefficient of a^order, 2 or 3, of f(u_0 + a v + a^2 w) by central differences. The signs
// separate even from odd orders; a second step removes the h^2 term of the error (Richardson).
VectorXd by_differences(const EquilibriumSolver& solver, const VectorXd& u_0, const VectorXd& v,
                        const VectorXd& w, int order, double h) {
  const auto at = [&](double a) { return internal_force(solver, u_0 + a * v + a * a * w); };
  const auto coefficient = [&](double step) -> VectorXd {
    if (order == 2) return (at(step) - 2 * at(0) + at(-step)) / (2 * step * step);
    return (at(2 * step) - 2 * at(step) + 2 * at(-step) - at(-2 * step)) /
           (12 * step * step * step);
  };
  return (4 * coefficient(h / 2) - coefficient(h)) / 3;
}

void check_terms(const SolidModel& model, const Preloaded* preloaded) {
  const LoadResponse response(model, preloaded);
  const EquilibriumSolver solver(model);
  const VectorXd u_0 = response.rest().reshaped();
  const VectorXd v = some_field(response, 1), w = some_field(response, 2);
  const VectorXd zero = VectorXd::Zero(v.size());

  const VectorXd second = by_differences(solver, u_0, v, zero, 2, 0.1);
  CHECK((response.second_force(v) - second).norm() <=
        tolerance(2e-6, "h^4 of the sixth order, rounding over h^2") * second.norm());
  const VectorXd third = by_differences(solver, u_0, v, w, 3, 0.2);
  CHECK((response.third_force(v, w) - third).norm() <=
        tolerance(2e-4, "h^4 of the seventh order, rounding over h^3") * third.norm());
  const VectorXd mixed = response.mixed_force(v, w);
  CHECK((mixed - response.mixed_force(w, v)).norm() <= 1e-14 * mixed.norm());
  const VectorXd along = 0.5 * (response.mixed_force(v, v));
  CHECK((along - response.second_force(v)).norm() <=
        tolerance(1e-12, "sums of three passes") * along.norm());
}

TEST_CASE("the terms of the forces are what differences of the forces say, for every law",
          "[solid][response]") {
  for (const std::string& law : law_names()) {
    SolidModel model = block(law);
    DYNAMIC_SECTION(law << " at rest") { check_terms(model, nullptr); }
    DYNAMIC_SECTION(law << " with 10-node tetrahedra") {
      model.mesh = with_edge_nodes(model.mesh);
      model.fixed_nodes.clear();
      for (int n = 0; n < model.mesh.node_count(); ++n) {
        if (model.mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
      }
      check_terms(model, nullptr);
    }
    DYNAMIC_SECTION(law << " under a load that stretches it by a tenth") {
      Matrix3Xd f = Matrix3Xd::Zero(3, model.mesh.node_count());
      for (int n = 0; n < model.mesh.node_count(); ++n) {
        if (model.mesh.nodes(2, n) > 0.049) f(2, n) = 0.6;
      }
      const EquilibriumSolver solver(model);
      const std::array level{1.0};
      const PathResult path = solver.solve_path(f, level);
      REQUIRE(path.complete);
      const Preloaded preloaded{f, path.steps[0].displacement};
      CHECK(preloaded.rest.cwiseAbs().maxCoeff() > 0.004);
      check_terms(model, &preloaded);
    }
  }
}

TEST_CASE("of St. Venant-Kirchhoff's law the first three orders are those of its own series",
          "[solid][response]") {
  const SolidModel model = test::small_beam();
  const LoadResponse response(model);
  const LoadSeries series(model);
  const VectorXd f =
      Eigen::MatrixXd(test::face_loads(model, test::face_nodes(model, 0.05, 0.1), -2.0))
          .rightCols(1);
  const LoadOrders orders = series.solve(f, {.most_orders = 3, .tolerance = 0})[0];
  const VectorXd u_1 = response.linear(f);
  const VectorXd u_2 = -response.linear(response.second_force(u_1));
  const VectorXd u_3 = -response.linear(response.third_force(u_1, u_2));
  const double rounding = tolerance(1e-9, "of the factor: a slender beam");
  CHECK((u_1 - orders.u.col(0)).norm() <= rounding * u_1.norm());
  CHECK((u_2 - orders.u.col(1)).norm() <= rounding * u_2.norm());
  CHECK((u_3 - orders.u.col(2)).norm() <= rounding * u_3.norm());
}

TEST_CASE("three orders leave an error of the fourth", "[solid][response][order]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const SolidModel model = block(law);
    const LoadResponse response(model);
    Matrix3Xd force = Matrix3Xd::Zero(3, model.mesh.node_count());
    for (int n = 0; n < model.mesh.node_count(); ++n) {
      const auto X = model.mesh.nodes.col(n);
      if (X[2] > 0.049 && X[0] > 0.014) force.col(n) = Eigen::Vector3d(-0.2, 0, -0.4);
    }
    const VectorXd f = force.reshaped();
    const VectorXd u_1 = response.linear(f);
    const VectorXd u_2 = -response.linear(response.second_force(u_1));
    const VectorXd u_3 = -response.linear(response.third_force(u_1, u_2));
    const EquilibriumSolver solver(model, {.tolerance = 1e-12});
    const std::array levels{0.25, 0.5};
    const PathResult path = solver.solve_path(force, levels);
    REQUIRE(path.complete);
    std::array<double, 2> error{};
    for (std::size_t l = 0; l < 2; ++l) {
      const double a = levels[l];
      const VectorXd u = a * u_1 + a * a * u_2 + a * a * a * u_3;
      error[l] = (u - path.steps[l].displacement.reshaped()).norm();
    }
    const double order = std::log2(error[1] / error[0]);
    CHECK(order > 4 - tolerance(0.15, "the fifth order at a quarter of the load"));
    CHECK(order < 4 + tolerance(0.5, "the fifth order, with its sign"));
  }
}

}  // namespace
}  // namespace palpable
