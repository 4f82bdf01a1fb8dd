#include "palpable/bake/touch_bake/touch_maker.h"

#include "palpable/common/response/shell_stress.h"
#include "palpable/common/response/touch_solver.h"
#include "tests/support/allocations.h"
#include "tests/support/ball_gap.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::VectorXd;
using test::tolerance;

// 60 x 50 x 40 mm.
SolidModel block() {
  return test::standing_rubber(box_tets({0, 0, 0}, {0.06, 0.05, 0.04}, 8, 7, 6));
}

// A ball of 12 mm that enters the block from above.
test::GapFunction ball(float depth) {
  constexpr float kRadius = 0.012f;
  return test::gap_to_ball({0.022f, 0.024f, 0.04f + kRadius - depth}, kRadius);
}

TEST_CASE("the stress of a touched body is found in one frame of several steps, without allocating",
          "[touch_bake]") {
  const SolidModel model = block();
  const SkinResponse skin(model, boundary_of(model.mesh));
  TouchBakeSettings settings;
  settings.regions.most = settings.cross.modes = 0;
  const TouchTables tables = make_touch_tables(skin, settings);
  REQUIRE(trouble_of(tables, skin.skin()).empty());
  const auto V = static_cast<std::size_t>(skin.vertex_count());
  TouchSolver solver(skin.skin(), skin.fixed(), tables);
  TouchState state;
  std::vector<float> shown(V), tensors(6 * V);
  solver.stress(state, shown);
  CHECK(std::all_of(shown.begin(), shown.end(), [](float value) { return value == 0.0f; }));
  CHECK(solver.advance(state, ball(0.0030f)).steps == 3);
  REQUIRE(state.u.cols() == skin.shell_count());
  CHECK(test::allocations_during([&] { solver.stress(state, shown, tensors); }) == 0);

  // The linear displacement of the whole mesh under the same forces.
  VectorXd load = VectorXd::Zero(3 * static_cast<Index>(V));
  for (const PointForce& force : state.forces) {
    const SkinPoint& point = solver.points()[static_cast<std::size_t>(force.point)];
    for (std::size_t k = 0; k < 3; ++k) {
      load.segment<3>(3 * Index{point.corners[k]}) +=
          (point.weights[static_cast<Index>(k)] * force.force).cast<double>();
    }
  }
  const VectorXd u = skin.body().linear(skin.at_nodes(load)).col(0);
  std::vector<float> exact(V);
  ShellStress(tables.shell, skin.vertex_count())
      .evaluate(skin.in_shell(u).reshaped(3, skin.shell_count()).cast<float>(), exact);
  const float largest = *std::max_element(exact.begin(), exact.end());
  CHECK(largest > 1e3f);
  double worst = 0;
  for (std::size_t v = 0; v < V; ++v) {
    worst = std::max(worst, static_cast<double>(std::abs(shown[v] - exact[v])));
  }
  CHECK(worst < tolerance(0.02, "32 columns of clusters far away") * static_cast<double>(largest));
  CHECK(stress_bytes_of(tables) < bytes_of(tables));
}

}  // namespace
}  // namespace palpable
