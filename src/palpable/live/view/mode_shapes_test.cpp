#include "palpable/live/view/mode_shapes.h"

#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

// Two modes, the first of them in two products: u = F_0 (G_0 a + G_1 a^2) + F_1 G_2 a.
ReducedBody body_of_products() {
  ReducedBody body = test::pressed_ball(0.05, 0.01, 1);
  const SeparatedField& field = body.displacement;
  Eigen::MatrixXf F(field.value_count(), 3);
  F << field.modes().col(0), field.modes().col(0), field.modes().col(4);
  std::vector<ParameterAxis> axes = field.axes();
  axes[0].functions = Eigen::MatrixXd(6, 3);
  axes[0].functions << 1, 1, 0.5, 2, 2, 0.5, 3, -1, 0.5, 4, -3, -2, 1, 0, 0, 2, 1, 1;
  const Eigen::VectorXd a = axes[1].samples;
  axes[1].functions = Eigen::MatrixXd(a.size(), 3);
  axes[1].functions << a, a.cwiseAbs2(), a;
  body.displacement = {F, axes};
  return body;
}

TEST_CASE("products of one mode are one mode, as large as it gets under the full load",
          "[view][mode_shapes]") {
  const ReducedBody body = body_of_products();
  const std::vector<ModeShape> shapes = first_modes(body, 9).value();
  REQUIRE(shapes.size() == 2);
  // G_0 + G_1: 2 4 2 1 1 3.
  CHECK(shapes[0].over_sites.isApprox(
      (Eigen::VectorXd(6) << 0.5, 1, 0.5, 0.25, 0.25, 0.75).finished()));
  CHECK(shapes[0].displacement.isApprox(4.0f * body.displacement.modes().col(0)));
  CHECK(shapes[0].largest == Approx(0.04).epsilon(test::tolerance(1e-6, "single precision")));
  CHECK(shapes[1].over_sites[3] == -1.0);
  CHECK(first_modes(body, 1).value().size() == 1);

  CHECK_THAT(first_modes(test::pressed_ball(), 4).problem().message,
             Catch::Contains("'ball' has modes of its own for each site"));
}

TEST_CASE("modes of stress are as large as their von Mises stress, and move nothing",
          "[view][mode_shapes]") {
  ReducedBody body = body_of_products();
  Eigen::MatrixXf F(body.stress.value_count(), 2);
  F << body.stress.modes().col(0), body.stress.modes().col(4);
  std::vector<ParameterAxis> axes = body.displacement.axes();
  for (ParameterAxis& axis : axes) axis.functions = axis.functions.rightCols(2).eval();
  body.stress = {F, axes};
  const std::vector<ModeShape> shapes = first_modes(body, 2, ModeField::kStress).value();
  REQUIRE(!shapes.empty());
  const SeparatedField& field = body.stress;
  const Eigen::Index V = body.surface.vertices.cols();
  CHECK(shapes[0].displacement.size() == 0);
  REQUIRE(shapes[0].size.size() == V);
  // The von Mises stress of the first mode where its factor is largest, computed independently.
  double most = 0;
  const Eigen::MatrixXd &G = field.axes()[0].functions, &level = field.axes()[1].functions;
  for (Eigen::Index s = 0; s < G.rows(); ++s) {
    most = std::max(most, std::abs(G(s, 0) * level(level.rows() - 1, 0)));
  }
  const Eigen::VectorXd sigma = most * field.modes().col(0).cast<double>();
  for (Eigen::Index v = 0; v < V; ++v) {
    const Eigen::Matrix<double, 6, 1> x = sigma.segment<6>(6 * v);
    const double expected =
        std::sqrt(0.5 * ((x[0] - x[1]) * (x[0] - x[1]) + (x[1] - x[2]) * (x[1] - x[2]) +
                         (x[2] - x[0]) * (x[2] - x[0])) +
                  3 * (x[3] * x[3] + x[4] * x[4] + x[5] * x[5]));
    CHECK(static_cast<double>(shapes[0].size[v]) ==
          Approx(expected).epsilon(test::tolerance(1e-4, "single precision")).margin(1e-3));
  }
}

TEST_CASE("a function of the position is painted where its sites' patches are",
          "[view][mode_shapes]") {
  const ReducedBody body = body_of_products();
  const Eigen::VectorXd values = on_skin(body, (Eigen::VectorXd(6) << 1, 2, 3, 4, 5, 6).finished());
  for (int s = 0; s < 6; ++s) CHECK(values[body.sites[s].vertex] == s + 1);
  std::vector<bool> held(values.size());
  for (const Site& site : body.sites) {
    for (const int v : site.patch) held[v] = true;
  }
  for (Eigen::Index v = 0; v < values.size(); ++v) { CHECK(std::isnan(values[v]) == !held[v]); }
}

}  // namespace
}  // namespace palpable
