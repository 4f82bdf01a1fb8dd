#include "palpable/bake/campaign/import_checks.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <numeric>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3Xd;

// A block of 60 x 40 x 50 mm that stands on the ground.
SolidModel block() {
  SolidModel model;
  model.mesh = box_tets({-0.03, -0.02, 0}, {0.03, 0.02, 0.05}, 4, 3, 4);
  model.material = material_from_young("neo-hookean", 60e3, 0.4);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
  }
  return model;
}

// m: sheared along x and compressed along z, zero on the ground.
Matrix3Xd pressed(const TetMesh& mesh) {
  Matrix3Xd u = Matrix3Xd::Zero(3, mesh.node_count());
  u.row(0) = 0.1 * mesh.nodes.row(2);
  u.row(2) = -0.05 * mesh.nodes.row(2);
  return u;
}

std::vector<std::int64_t> numbers_from_one(int count) {
  std::vector<std::int64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 1);
  return numbers;
}

TEST_CASE("imported displacement moves no held node and stays in the range", "[campaign][import]") {
  const SolidModel model = block();
  const std::vector<HeldComponent> held = held_components(model);
  const std::vector<std::int64_t> numbers = numbers_from_one(model.mesh.node_count());
  const Matrix3Xd u = pressed(model.mesh);
  CHECK_NOTHROW(refuse_moved_support(held, u, numbers, "a"));
  // Some solvers hold a support by stiff springs: its nodes then move a little, here by 1 % of the
  // largest displacement. That is accepted.
  Matrix3Xd sprung = u;
  sprung(0, model.fixed_nodes[3]) = 0.01 * u.colwise().norm().maxCoeff();
  CHECK_NOTHROW(refuse_moved_support(held, sprung, numbers, "a"));
  const Matrix3Xd reversed = u.rowwise().reverse();
  CHECK_THROWS_WITH(refuse_moved_support(held, reversed, numbers, "runs.toml: [[snapshot]] 1"),
                    Contains("runs.toml: [[snapshot]] 1: node ") &&
                        Contains("held by the support and moves by 5 mm along x") &&
                        Contains("order of the mesh's nodes"));
  // x of all nodes, then y, then z, read as x y z of one node after the other.
  const Eigen::VectorXd by_component = Eigen::MatrixXd(u.transpose()).reshaped();
  const Matrix3Xd mixed = by_component.reshaped(3, u.cols());
  CHECK_THROWS_WITH(refuse_moved_support(held, mixed, numbers, "a"), Contains("components x y z"));
  CHECK_NOTHROW(refuse_far_displacement(held, u, 0.02, "a"));
  CHECK_THROWS_WITH(
      refuse_far_displacement(held, 1000.0 * u, 0.02, "a"),
      Contains("a: a node moves by") && Contains("more than 20 mm") && Contains("'unit'"));
}

TEST_CASE("a support that moves is no moved support", "[campaign][import]") {
  SolidModel model = block();
  model.fixed_displacement = Matrix3Xd::Constant(3, std::ssize(model.fixed_nodes), 0.01);
  const Matrix3Xd u = pressed(model.mesh).colwise() + Eigen::Vector3d::Constant(0.01);
  const std::vector<HeldComponent> held = held_components(model);
  CHECK_NOTHROW(refuse_moved_support(held, u, numbers_from_one(model.mesh.node_count()), "a"));
}

TEST_CASE("imported stress is compared with the law: unit, order, and right ones",
          "[campaign][import]") {
  const SolidModel model = block();
  const Matrix3Xd u = pressed(model.mesh);
  const StressField stress = nodal_cauchy_stress(model, u);
  const StressJudgement right = judge_stress(model, u, stress);
  CHECK_FALSE(right.is_warning);
  CHECK_THAT(right.text, Contains("the law gives"));
  CHECK_FALSE(judge_stress(model, u, 1.5 * stress).is_warning);  // another element, or a softer law
  for (const double factor : {1e-6, 1e-3, 4.0, 1e6}) {
    INFO(factor);
    const StressJudgement wrong = judge_stress(model, u, factor * stress);
    CHECK(wrong.is_warning);
    CHECK_THAT(wrong.text, Contains("unit of stress"));
  }
  // xx xy xz yy yz zz, as XDMF has it.
  const StressField other = stress(std::vector<int>{0, 3, 5, 1, 4, 2}, Eigen::all);
  const StressJudgement order = judge_stress(model, u, other);
  CHECK(order.is_warning);
  CHECK(judge_stress(model, u, -1.0 * stress).is_warning);  // a sign
  Matrix3Xd inside_out = u;
  inside_out.row(2) = -2.0 * model.mesh.nodes.row(2);
  CHECK_THAT(judge_stress(model, inside_out, stress).text, Contains("was not judged"));
}

}  // namespace
}  // namespace palpable
