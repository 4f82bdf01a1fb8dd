#include "palpable/bake/touch_bake/full_solution.h"

#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

using Eigen::VectorXd;
using test::tolerance;

TEST_CASE("the full-order solution agrees with the series up to its third order", "[touch_bake]") {
  const SolidModel model =
      test::standing_rubber(box_tets({-0.03, -0.025, 0}, {0.03, 0.025, 0.04}, 6, 5, 4));
  const EquilibriumSolver solver(model, {.tolerance = kFullSolutionTolerance});
  const SkinResponse skin(model, boundary_of(model.mesh));
  int top = 0;
  for (int v = 0; v < skin.vertex_count(); ++v)
    if (skin.skin().vertices(2, v) > skin.skin().vertices(2, top)) top = v;
  const auto load = [&](float newton) {
    return std::vector<VertexForce>{{top, {0.5f * newton, 0, -newton}}};
  };
  // The first three orders of the displacement under a force that moves the vertex by some
  // millimetres.
  VectorXd force = VectorXd::Zero(3 * skin.vertex_count());
  force.segment<3>(3 * top) = load(0.5f)[0].force.cast<double>();
  const LoadResponse& body = skin.body();
  const VectorXd u_1 = body.linear(skin.at_nodes(force));
  const VectorXd u_2 = -body.linear(body.second_force(u_1));
  const VectorXd u_3 = -body.linear(body.third_force(u_1, u_2));
  const auto error = [&](const VectorXd& u) {
    const auto exact = full_solution(solver, skin, nullptr, load(0.5f));
    REQUIRE(exact);
    REQUIRE(exact->cols() == skin.shell_count());
    const VectorXd wanted = skin.in_shell(u);
    return (exact->reshaped().cast<double>() - wanted).norm() / wanted.norm();
  };
  const double one = error(u_1), two = error(u_1 + u_2), three = error(u_1 + u_2 + u_3);
  CHECK(one > 0.01);
  CHECK(two < 0.5 * one);
  CHECK(three < 0.5 * two);

  CHECK_FALSE(full_solution(solver, skin, nullptr, {}));
  CHECK_FALSE(full_solution(solver, skin, nullptr, load(1e6f)));
  const int held = static_cast<int>(std::find(skin.fixed().begin(), skin.fixed().end(), 1) -
                                    skin.fixed().begin());
  CHECK_FALSE(full_solution(solver, skin, nullptr, std::vector<VertexForce>{{held, {0, 0, 1}}}));
}

}  // namespace
}  // namespace palpable
