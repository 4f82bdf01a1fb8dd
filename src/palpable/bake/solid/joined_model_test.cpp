#include "palpable/bake/solid/joined_model.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/selection.h"
#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <array>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

Rigid3 turned(double angle, const Vector3d& to) {
  Rigid3 pose = Rigid3::Identity();
  pose.rotate(Eigen::AngleAxisd(angle, Vector3d(1, 2, -1).normalized()));
  pose.translation() = to;
  return pose;
}

Matrix3Xd solved(const SolidModel& model, const Matrix3Xd& load) {
  const std::array<double, 1> full{1.0};
  const PathResult path = EquilibriumSolver(model).solve_path(load, full);
  REQUIRE(path.complete);
  return path.steps.back().displacement;
}

TEST_CASE("bodies that are joined answer their loads as each of them alone", "[solid][joined]") {
  SolidModel one = test::small_beam(6, 2, 1), other = test::small_beam(5, 3, 2);
  other.material = material_from_young("neo-hookean", 1e6, 0.4);
  other.groups = {{material_from_young("neo-hookean", 3e6, 0.2), {3, 7, 8, 40}}};
  other.supports = {
      {nearest_node(other.mesh, {0.4, 0.1, 0.05}), {true, true, true}, Vector3d(0, 0.001, 0)}};
  const std::array<SolidModel, 2> bodies{one, other};
  const std::array<Rigid3, 2> poses{turned(0.3, {0, 0, 1}), turned(-1.1, {0.5, -2, 0})};
  const JoinedModel both = joined(bodies, poses);
  REQUIRE(both.first_node == std::vector<int>{0, one.mesh.node_count(),
                                              one.mesh.node_count() + other.mesh.node_count()});
  REQUIRE(both.first_tet.back() == both.model.mesh.tet_count());
  Matrix3Xd load = Matrix3Xd::Zero(3, both.model.mesh.node_count());
  std::array<Matrix3Xd, 2> alone;
  for (int b = 0; b < 2; ++b) {
    const int N = bodies[b].mesh.node_count();
    Matrix3Xd own = Matrix3Xd::Zero(3, N);
    own.col(nearest_node(bodies[b].mesh, {0.4, 0.05, 0.0})) = Vector3d(0.1, 0.2, -0.3);
    load.middleCols(both.first_node[b], N) = poses[b].linear() * own;
    alone[b] = poses[b].linear() * solved(bodies[b], own);
  }
  const Matrix3Xd together = solved(both.model, load);
  for (int b = 0; b < 2; ++b) {
    const auto part = together.middleCols(both.first_node[b], bodies[b].mesh.node_count());
    CHECK((part - alone[b]).norm() <=
          tolerance(1e-5, "both are solved to 1e-7 of the forces") * alone[b].norm());
  }
}

TEST_CASE("bodies that cannot be joined are refused", "[solid][joined][errors]") {
  std::array<SolidModel, 2> bodies{test::small_beam(2, 1, 1), test::small_beam(2, 1, 1)};
  std::array<Rigid3, 2> poses{Rigid3::Identity(), Rigid3::Identity()};
  bodies[1].supports = {{5, {false, true, false}}};
  CHECK(joined(bodies, poses).model.supports[0].node == bodies[0].mesh.node_count() + 5);
  poses[1] = turned(0.1, {0, 0, 0});
  CHECK_THROWS_WITH(joined(bodies, poses), Catch::Matchers::Contains("in some directions only"));
  bodies[1].supports.clear();
  bodies[1].mesh = with_edge_nodes(bodies[1].mesh);
  CHECK_THROWS_WITH(joined(bodies, poses), Catch::Matchers::Contains("mesh all of them alike"));
}

}  // namespace
}  // namespace palpable
