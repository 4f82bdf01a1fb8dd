#include "bench/bake/calculix_comparison.h"

#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <array>

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("the worst level, node and component of two paths is what their difference says",
          "[bake][calculix]") {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.2}, 1, 1, 2);
  model.material = material_from_young("neo-hooke-abaqus", 1e4, 0.3);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  const int tip = model.mesh.node_count() - 1;
  const Eigen::Matrix3Xd load =
      0.5 * patch_force(model.mesh.node_count(), std::array{tip}, std::array{1.0}, {1, 0.2, -0.3});
  const PathResult ours = EquilibriumSolver(model).solve_path(load, std::array{0.5, 1.0});
  REQUIRE(ours.complete);
  CalculixRun theirs;
  for (const Equilibrium& step : ours.steps) {
    theirs.states.push_back({.level = step.level,
                             .displacement = step.displacement,
                             .stress = point_cauchy_stress(model, step.displacement)});
  }
  const PathDifference same = compare_paths(model, ours, theirs);
  CHECK(same.levels == 2);
  CHECK(same.displacement == 0.0);
  CHECK(same.stress == 0.0);
  CHECK(same.largest_displacement == ours.steps[1].displacement.colwise().norm().maxCoeff());

  // 1 % of the largest value of the first level, which is smaller than that of the second level.
  const double u = ours.steps[0].displacement.colwise().norm().maxCoeff();
  theirs.states[0].displacement.col(tip) += Eigen::Vector3d(0.006, 0.008, 0) * u;
  const double sigma = theirs.states[0].stress.cwiseAbs().maxCoeff();
  theirs.states[0].stress(4, 3) -= 0.02 * sigma;
  const double rounding = tolerance(1e-12, "rounding");
  CHECK(compare_paths(model, ours, theirs).displacement == Approx(0.01).epsilon(rounding));
  CHECK(compare_paths(model, ours, theirs).stress == Approx(0.02).epsilon(rounding));

  theirs.states.pop_back();  // as if CalculiX had stopped early
  CHECK(compare_paths(model, ours, theirs).levels == 1);
  theirs.states[0].level = 0.75;
  CHECK_THROWS_AS(compare_paths(model, ours, theirs), ContractViolation);
}

}  // namespace
}  // namespace palpable
