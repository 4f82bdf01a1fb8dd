#include "palpable/bake/solid/solve_tables.h"

#include "tests/support/test.h"

#include <limits>

namespace palpable {
namespace {

TEST_CASE("the table of a path has a row for each Newton step and one for each state",
          "[solid][text]") {
  PathResult path;
  Equilibrium easy;
  easy.displacement = Eigen::Matrix3Xd::Constant(3, 2, 0.001);
  easy.level = 0.25;
  easy.residual = 1e-9;
  easy.smallest_volume_ratio = 0.875;
  Equilibrium hard = easy;
  hard.displacement *= 3;
  hard.level = 0.5;
  hard.convergence = {{0.5, 12, 1}, {0.0625, 7, 0.25}};
  path.steps = {easy, hard};
  Eigen::Matrix3Xd unit = Eigen::Matrix3Xd::Zero(3, 2);
  unit(2, 1) = 1;
  const Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Constant(3, 2, 0.0005);
  CHECK(path_table(path, unit, rest) ==
        "   level Newton   residual     CG  share  press / mm  smallest J\n"
        "    0.25      0    1.0e-09                    0.5000       0.875\n"
        "     0.5      0    5.0e-01     12      1\n"
        "              1    6.2e-02      7   0.25\n"
        "              2    1.0e-09                    2.5000       0.875\n");
}

TEST_CASE("the row of a contact says how well its conditions hold", "[solid][contact][text]") {
  ContactState state;
  state.t = 0.5;
  state.force = Eigen::Vector3d(1, -2, 0.25);
  state.touching = 31;
  state.smallest_gap = -2e-8;
  state.entry_between = 3e-6;
  state.complementarity = 4e-10;
  state.residual = 5e-8;
  state.newton_steps = 6;
  state.cg_iterations = 70;
  state.smallest_volume_ratio = 0.75;
  CHECK(
      contact_heading() ==
      "   way      Fx/N      Fy/N      Fz/N points    gap/mm   between    f.gap  residual  Newton "
      "   CG least J\n");
  CHECK(
      contact_row(state) ==
      "   0.5    1.0000   -2.0000    0.2500     31  -2.0e-05   3.0e-03  4.0e-10   5.0e-08       6 "
      "   70   0.750\n");
  state.touching = 0;  // without contact the residual has no scale
  state.smallest_gap = std::numeric_limits<double>::infinity();
  CHECK(
      contact_row(state) ==
      "   0.5    1.0000   -2.0000    0.2500      0         -   3.0e-03  4.0e-10   0.0e+00       6 "
      "   70   0.750\n");
}

}  // namespace
}  // namespace palpable
