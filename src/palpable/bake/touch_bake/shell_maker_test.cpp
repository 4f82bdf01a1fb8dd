#include "palpable/bake/touch_bake/shell_maker.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/response/shell_stress.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::tolerance;

// A block that stands on its lowest nodes; its upper half is made of another rubber.
SolidModel block(bool quadratic) {
  SolidModel model = test::standing_rubber(
      quadratic ? with_edge_nodes(box_tets({0, 0, 0}, {0.06, 0.05, 0.04}, 4, 3, 3))
                : box_tets({0, 0, 0}, {0.06, 0.05, 0.04}, 7, 6, 5));
  MaterialGroup upper{material_from_young("mooney-rivlin", 30e3, 0.3), {}};
  for (int e = 0; e < model.mesh.tet_count(); ++e) {
    if (model.mesh.nodes(2, model.mesh.tets.col(e)).mean() > 0.02) upper.elements.push_back(e);
  }
  model.groups.push_back(upper);
  return model;
}

// A dent of some millimetres, a shear and a wave.
Matrix3Xd some_displacement(const SolidModel& model) {
  Matrix3Xd u(3, model.mesh.node_count());
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    const Vector3d X = model.mesh.nodes.col(n);
    const double dent = std::exp(-(X - Vector3d(0.02, 0.02, 0.04)).squaredNorm() / 2e-4);
    u.col(n) = Vector3d(0.06 * X[1] * X[2] / 0.05, 0.002 * std::sin(90 * X[0]), -0.006 * dent);
  }
  return u;
}

// Von Mises stress at the skin's vertices by the full recovery, Pa.
VectorXd full_von_mises(const SkinResponse& skin, const Matrix3Xd& u) {
  const VectorXd nodal = von_mises(nodal_cauchy_stress(skin.body().model(), u));
  VectorXd on_skin(skin.vertex_count());
  for (int v = 0; v < skin.vertex_count(); ++v) on_skin[v] = nodal[skin.node_of(v)];
  return on_skin;
}

VectorXd shell_von_mises(const SkinResponse& skin, const Matrix3Xd& from_rest) {
  ShellStress stress(make_shell(skin), skin.vertex_count());
  std::vector<float> found(static_cast<std::size_t>(skin.vertex_count()));
  stress.evaluate(skin.in_shell(from_rest.reshaped()).reshaped(3, skin.shell_count()).cast<float>(),
                  found);
  return Eigen::Map<const Eigen::VectorXf>(found.data(), skin.vertex_count()).cast<double>();
}

TEST_CASE("the shell gives the full solver's stress for the true displacement", "[touch_bake]") {
  for (const bool quadratic : {false, true}) {
    INFO((quadratic ? "10 nodes" : "4 nodes"));
    const SolidModel model = block(quadratic);
    const SkinResponse skin(model, boundary_of(model.mesh));
    const Matrix3Xd u = some_displacement(model);
    const VectorXd exact = full_von_mises(skin, u), found = shell_von_mises(skin, u);
    CHECK((found - exact).cwiseAbs().maxCoeff() <
          tolerance(1e-5 * exact.maxCoeff(), "single precision"));
    CHECK(exact.maxCoeff() > 5e3);
  }
}

TEST_CASE("a body deformed by its weight starts from the stress of that state", "[touch_bake]") {
  const SolidModel model = block(false);
  const EquilibriumSolver solver(model);
  Preloaded preloaded{Matrix3Xd::Zero(3, model.mesh.node_count()), {}};
  preloaded.force.row(2).setConstant(-0.01);
  const double all[] = {1.0};
  const PathResult path = solver.solve_path(preloaded.force, all);
  REQUIRE(path.complete);
  preloaded.rest = path.steps.back().displacement;
  const SkinResponse skin(model, boundary_of(model.mesh), &preloaded);
  const Matrix3Xd u = 0.5 * some_displacement(model);
  for (const double share : {0.0, 1.0}) {
    const VectorXd exact = full_von_mises(skin, skin.body().rest() + share * u);
    const VectorXd found = shell_von_mises(skin, share * u);
    CHECK((found - exact).cwiseAbs().maxCoeff() <
          tolerance(1e-5 * exact.maxCoeff(), "single precision"));
    CHECK(exact.maxCoeff() > 1e3);
  }
}

TEST_CASE("the shell has the nodes of its elements, the skin's first and each once",
          "[touch_bake]") {
  for (const bool quadratic : {false, true}) {
    const SolidModel model = block(quadratic);
    const SkinResponse skin(model, boundary_of(model.mesh));
    const ShellTable shell = make_shell(skin);
    CHECK(trouble_of(shell, skin.vertex_count()).empty());
    for (int v = 0; v < skin.vertex_count(); ++v) {
      CHECK(shell.stress_free.col(v) == model.mesh.nodes.col(skin.node_of(v)));
    }
    std::set<int> used(shell.elements.begin(), shell.elements.end());
    for (int v = 0; v < skin.vertex_count(); ++v) used.insert(v);
    CHECK(static_cast<int>(used.size()) == shell.nodes());
    CHECK(std::set<int>(skin.shell_nodes().begin(), skin.shell_nodes().end()).size() ==
          skin.shell_nodes().size());
  }
}

}  // namespace
}  // namespace palpable
