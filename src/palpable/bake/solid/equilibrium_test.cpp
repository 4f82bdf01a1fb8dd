#include "palpable/bake/solid/equilibrium.h"

#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/tet_assembly.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

constexpr double kSide = 0.1;  // m

// A soft cube of 0.1 m, held at its lower face.
SolidModel cube(const std::string& law = "neo-hookean", int cells = 6) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {kSide, kSide, kSide}, cells, cells, cells);
  model.material = material_from_young(law, 60e3, 0.4);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  return model;
}

// 1 N, on the nodes of the skin within 0.025 m of X, towards the middle of the cube.
Matrix3Xd press_at(const SolidModel& model, const Vector3d& X) {
  std::vector<int> patch;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    const Vector3d at = model.mesh.nodes.col(n);
    const bool skin = (at.array() == 0.0).any() || (at.array() == kSide).any();
    if (skin && (at - X).norm() < 0.025) patch.push_back(n);
  }
  const std::vector<double> weights(patch.size(), 1.0);
  return patch_force(model.mesh.node_count(), patch, weights, Vector3d::Constant(kSide / 2) - X);
}

const Vector3d kTop(kSide / 2, kSide / 2, kSide);
const Vector3d kEdge(kSide, kSide / 2, kSide);

// Displacements of up to 0.002 m, small next to the mesh size of 0.017 m; zero at the held nodes.
Matrix3Xd some_displacement(const SolidModel& model, unsigned seed) {
  auto random = test::random_case(seed);
  std::uniform_real_distribution<double> shift(-0.002, 0.002);
  Matrix3Xd u(3, model.mesh.node_count());
  for (double& value : u.reshaped()) value = shift(random);
  for (const int n : model.fixed_nodes) u.col(n).setZero();
  return u;
}

TEST_CASE("the forces are the derivative of the stored energy", "[solid][assembly]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const SolidModel model = cube(law, 3);
    const EquilibriumSolver solver(model);
    const Matrix3Xd u = some_displacement(model, 1);
    const Matrix3Xd force = solver.internal_force(u);
    for (unsigned seed = 2; seed < 8; ++seed) {
      const Matrix3Xd du = some_displacement(model, seed);
      const double h = 1e-4;
      const double numeric =
          (solver.stored_energy(u + h * du) - solver.stored_energy(u - h * du)) / (2 * h);
      CHECK(numeric == Approx(force.cwiseProduct(du).sum())
                           .epsilon(tolerance(1e-6, "central differences, h = 1e-4")));
    }
  }
}

TEST_CASE("the assembled tangent is the derivative of the forces at the free nodes",
          "[solid][assembly]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const SolidModel model = cube(law, 3);
    const EquilibriumSolver solver(model);
    const Matrix3Xd u = some_displacement(model, 1);
    for (unsigned seed = 2; seed < 6; ++seed) {
      const Matrix3Xd du = some_displacement(model, seed);
      const double h = 1e-4;
      Matrix3Xd numeric =
          (solver.internal_force(u + h * du) - solver.internal_force(u - h * du)) / (2 * h);
      for (const int n : model.fixed_nodes) numeric.col(n).setZero();
      const Matrix3Xd exact = solver.tangent_times(u, du);
      CHECK((numeric - exact).norm() <=
            tolerance(1e-6, "central differences, h = 1e-4") * exact.norm());
    }
  }
}

TEST_CASE("a pass over the elements takes no memory", "[solid][assembly]") {
  const SolidModel model = cube("neo-hookean", 3);
  const TetAssembly assembly(model);
  const Matrix3Xd u = some_displacement(model, 1);
  Matrix3Xd force(3, model.mesh.node_count());
  BlockMatrix K(assembly.pattern());
  PassFields fields;
  assembly.set_state(u, fields);
  assembly.force(fields, force);  // allocates the buffers
  Eigen::VectorXd x = Eigen::VectorXd::Ones(3 * assembly.pattern().rows()), y = x;
  CHECK(test::allocations_during([&] {
          assembly.set_state(u, fields);
          assembly.force(fields, force);
          assembly.tangent(fields, K);
          assembly.tangent_product(fields, x, y);
        }) == 0);
}

TEST_CASE("every level of a path is in equilibrium with its load", "[solid][path]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const SolidModel model = cube(law);
    const EquilibriumSolver solver(model);
    const Matrix3Xd load = (law == "neo-hookean" ? 20.0 : 4.0) * press_at(model, kTop);
    const std::array levels{0.1, 0.4, 0.7, 1.0};
    const PathResult path = solver.solve_path(load, levels);
    INFO(path.why_stopped);
    REQUIRE(path.complete);
    CHECK(path.stop == Stop::kNone);
    CHECK(path.why_stopped.empty());
    REQUIRE(path.steps.size() == levels.size());
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const Equilibrium& step = path.steps[k];
      CHECK(step.level == levels[k]);
      CHECK(step.residual <= 1e-8);
      CHECK((step.smallest_volume_ratio > 0.3 && step.smallest_volume_ratio < 1.0));
      const Matrix3Xd force = solver.internal_force(step.displacement);
      Matrix3Xd left_over = levels[k] * load - force;
      for (const int n : model.fixed_nodes) {
        CHECK(step.displacement.col(n) == Vector3d::Zero());
        left_over.col(n).setZero();
      }
      CHECK(left_over.norm() <= 1e-8 * force.norm());
      // The reactions of the supports balance the load.
      Vector3d held = Vector3d::Zero();
      for (const int n : model.fixed_nodes) held += force.col(n);
      CHECK((held + levels[k] * load.rowwise().sum()).norm() <=
            tolerance(1e-7, "residuals of 250 nodes") * levels[k] * load.norm());
    }
  }
}

TEST_CASE("a state does not depend on the levels on the way to it", "[solid][path]") {
  const SolidModel model = cube();
  const EquilibriumSolver solver(model, {.tolerance = 1e-10});
  const Matrix3Xd load = 20.0 * press_at(model, kEdge);
  const std::array at_once{1.0};
  const std::array slowly{0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
  const PathResult a = solver.solve_path(load, at_once), b = solver.solve_path(load, slowly);
  REQUIRE((a.complete && b.complete));
  const Matrix3Xd& u = a.steps.back().displacement;
  CHECK(u.cwiseAbs().maxCoeff() > 0.005);  // a large press: this is not the linear problem
  CHECK((u - b.steps.back().displacement).norm() <=
        tolerance(1e-8, "two residuals of 1e-10 over a condition of tens") * u.norm());
}

TEST_CASE("the line search reaches a large press in one increment", "[solid][path]") {
  // From rest the full Newton step of this load turns elements inside out.
  const SolidModel model = cube("neo-hookean", 4);
  const Matrix3Xd load = 120.0 * press_at(model, kTop);
  const EquilibriumSolver solver(model, {.max_halvings = 0});
  const PathResult path = solver.solve_path(load, std::array{1.0});
  INFO(path.why_stopped);
  REQUIRE(path.complete);
  CHECK(path.steps.back().residual <= 1e-8);
  // It is the state that small increments lead to, not another one.
  const std::array slowly{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
  const PathResult followed = EquilibriumSolver(model).solve_path(load, slowly);
  REQUIRE(followed.complete);
  const Matrix3Xd& u = path.steps.back().displacement;
  CHECK((u - followed.steps.back().displacement).norm() <=
        tolerance(1e-6, "two residuals of 1e-8 over a condition of tens") * u.norm());
}

TEST_CASE("a turned body under a turned load answers with the turned displacement",
          "[solid][path]") {
  const SolidModel model = cube("neo-hookean", 4);
  const Matrix3Xd load = 15.0 * press_at(model, kEdge);
  const Matrix3d Q = Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  SolidModel turned = model;
  turned.mesh.nodes = Q * model.mesh.nodes;
  const EquilibriumSettings exact{.tolerance = 1e-11};
  const std::array levels{0.5, 1.0};
  const PathResult a = EquilibriumSolver(model, exact).solve_path(load, levels);
  const PathResult b = EquilibriumSolver(turned, exact).solve_path(Q * load, levels);
  REQUIRE((a.complete && b.complete));
  const Matrix3Xd& u = a.steps.back().displacement;
  CHECK((Q * u - b.steps.back().displacement).norm() <=
        tolerance(1e-9, "two residuals of 1e-11 over a condition of tens") * u.norm());
}

TEST_CASE("a load is found that presses as deep as wanted, and pressing with it gives that depth",
          "[solid][find-load]") {
  const SolidModel model = cube("neo-hookean", 5);
  const EquilibriumSolver solver(model);
  for (const Vector3d& site : {kTop, kEdge}) {
    const Matrix3Xd unit = press_at(model, site);
    for (const double wanted : {0.0005, 0.012}) {
      const LoadSearch found = solver.find_load(unit, wanted);
      INFO(found.why_stopped);
      REQUIRE(found.reached);
      CHECK(found.press == Approx(wanted).epsilon(tolerance(1.01e-6, "the documented tolerance")));
      CHECK(unit.cwiseProduct(found.state.displacement).sum() == found.press);
      CHECK(found.state.level == found.load);
      const std::array levels{0.5, 1.0};
      const PathResult path = solver.solve_path(found.load * unit, levels);
      REQUIRE(path.complete);
      const double press = unit.cwiseProduct(path.steps.back().displacement).sum();
      CHECK(press ==
            Approx(wanted).epsilon(tolerance(2e-6, "the search's tolerance and the solver's")));
    }
  }
}

TEST_CASE("a press that St. Venant-Kirchhoff does not survive is answered with the last good load",
          "[solid][find-load]") {
  const SolidModel model = cube("saint-venant-kirchhoff", 4);
  const EquilibriumSolver solver(model);
  const Matrix3Xd unit = press_at(model, kTop);
  const LoadSearch found = solver.find_load(unit, 0.06);
  CHECK_FALSE(found.reached);
  CHECK(found.stop != Stop::kNone);
  CHECK_THAT(found.why_stopped, Contains("60 mm was not reached") && Contains("last good"));
  CHECK((found.press > 0.002 && found.press < 0.06));
  CHECK(unit.cwiseProduct(found.state.displacement).sum() == found.press);
  // The state it ends with is a solution, and a path to just below it goes through.
  Matrix3Xd left_over = found.load * unit - solver.internal_force(found.state.displacement);
  for (const int n : model.fixed_nodes) left_over.col(n).setZero();
  CHECK(left_over.norm() <= 1e-7 * found.load * unit.norm());
  const std::array levels{0.3, 0.6, 0.9};
  CHECK(solver.solve_path(found.load * unit, levels).complete);
}

TEST_CASE("a press that is not reached is walked to a twentieth below what is borne",
          "[solid][find-load]") {
  const SolidModel model = cube("saint-venant-kirchhoff", 4);
  const EquilibriumSolver solver(model);
  const Matrix3Xd unit = press_at(model, kTop);
  const LoadSearch found = solver.find_load(unit, 0.06);
  const PressPath path = solver.press_path(unit, {.press = 0.06, .levels = 3});
  CHECK_FALSE(path.reached);
  REQUIRE(path.steps.size() == 3);
  CHECK(path.full_load ==
        Approx(0.95 * found.load)
            .epsilon(tolerance(0.005, "both stop at a last good load, not at the same one")));
}

TEST_CASE("a path that cannot go on keeps its good levels and says why", "[solid][path]") {
  const SolidModel model = cube("saint-venant-kirchhoff", 3);
  const EquilibriumSolver solver(model);
  const Matrix3Xd load = 400.0 * press_at(model, kTop);
  const std::array levels{0.001, 0.002, 0.5, 1.0};
  const PathResult path = solver.solve_path(load, levels);
  CHECK_FALSE(path.complete);
  CHECK(path.steps.size() == 2);
  CHECK(path.stop != Stop::kNone);
  CHECK(path.halvings > 0);
  CHECK_THAT(path.why_stopped, Contains("load level 0.5 was not reached, the last that was is 0."));
}

// Holds every node of the plane X_axis = value along its normal, at `displacement`.
void hold_plane(SolidModel& model, int axis, double value, double displacement = 0.0) {
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (std::abs(model.mesh.nodes(axis, n) - value) > 1e-12) continue;
    Support support{.node = n, .held = {false, false, false}};
    support.held[axis] = true;
    support.displacement[axis] = displacement;
    model.supports.push_back(support);
  }
}

TEST_CASE("a block on three symmetry planes, drawn out, becomes thin without stress across",
          "[solid][path][supports]") {
  SolidModel model = cube("neo-hookean", 3);
  model.fixed_nodes.clear();
  for (int axis = 0; axis < 3; ++axis) hold_plane(model, axis, 0.0);
  hold_plane(model, 2, kSide, 0.4 * kSide);
  const Matrix3Xd none = Matrix3Xd::Zero(3, model.mesh.node_count());
  const EquilibriumSolver solver(model, {.tolerance = 1e-10});
  const PathResult path = solver.solve_path(none, std::array{0.25, 0.5, 1.0});
  INFO(path.why_stopped);
  REQUIRE(path.complete);
  const Matrix3Xd& u = path.steps.back().displacement;
  // The deformation is diag(a, a, 1.4) X everywhere, with the a for which there is no transverse
  // stress.
  const double a = 1.0 + u(0, model.mesh.node_count() - 1) / kSide;
  const Matrix3d F = Vector3d(a, a, 1.4).asDiagonal();
  CHECK((a > 0.8 && a < 0.95));
  CHECK((u - (F - Matrix3d::Identity()) * model.mesh.nodes).norm() <=
        tolerance(1e-8, "residual of 1e-10 over a condition of tens") * u.norm());
  const Matrix3d P = first_piola(model.material, F);
  CHECK(std::abs(P(0, 0)) <= tolerance(1e-7, "as above") * P(2, 2));
  // The reactions at the upper face sum to stress times area.
  const Matrix3Xd force = solver.internal_force(u);
  double pull = 0.0;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) == kSide) pull += force(2, n);
  }
  CHECK(pull == Approx(P(2, 2) * kSide * kSide).epsilon(tolerance(1e-7, "as above")));
}

TEST_CASE("half a block on its plane of symmetry moves as the whole block does",
          "[solid][path][supports]") {
  // Two meshes that mirror each other make the whole, so that it is symmetric as the load is.
  SolidModel half;
  half.mesh = box_tets({0, 0, 0}, {kSide, kSide, kSide}, 3, 3, 3);
  half.material = material_from_young("neo-hookean", 60e3, 0.4);
  const int N = half.mesh.node_count();
  SolidModel whole = half;
  std::vector<int> mirrored(N);
  for (int n = 0; n < N; ++n) {
    if (half.mesh.nodes(2, n) == 0.0) half.fixed_nodes.push_back(n);
    int& other = mirrored[n];
    other = n;
    if (half.mesh.nodes(0, n) == 0.0) continue;
    other = whole.mesh.node_count();
    whole.mesh.nodes.conservativeResize(3, other + 1);
    whole.mesh.nodes.col(other) = Vector3d(-1, 1, 1).cwiseProduct(half.mesh.nodes.col(n));
  }
  const int E = half.mesh.tet_count();
  whole.mesh.tets.conservativeResize(4, 2 * E);
  for (int e = 0; e < E; ++e) {
    for (int k = 0; k < 4; ++k) { whole.mesh.tets(k, E + e) = mirrored[half.mesh.tets(k, e)]; }
    std::swap(whole.mesh.tets(2, E + e), whole.mesh.tets(3, E + e));
  }
  for (int n = 0; n < whole.mesh.node_count(); ++n) {
    if (whole.mesh.nodes(2, n) == 0.0) whole.fixed_nodes.push_back(n);
  }
  hold_plane(half, 0, 0.0);
  // 8 N on the upper edge x = side, leaning outwards, and its mirror image.
  Matrix3Xd load = Matrix3Xd::Zero(3, N);
  Matrix3Xd both = Matrix3Xd::Zero(3, whole.mesh.node_count());
  for (int n = 0; n < N; ++n) {
    if (half.mesh.nodes(0, n) != kSide || half.mesh.nodes(2, n) != kSide) continue;
    load.col(n) = Vector3d(1, 0.5, -2);
    both.col(n) = load.col(n);
    both.col(mirrored[n]) = Vector3d(-1, 0.5, -2);
  }
  const EquilibriumSettings exact{.tolerance = 1e-10};
  const PathResult a = EquilibriumSolver(half, exact).solve_path(load, std::array{0.5, 1.0});
  const PathResult b = EquilibriumSolver(whole, exact).solve_path(both, std::array{0.5, 1.0});
  REQUIRE((a.complete && b.complete));
  const Matrix3Xd& u = a.steps.back().displacement;
  CHECK(u.cwiseAbs().maxCoeff() > 0.004);
  CHECK((u - b.steps.back().displacement.leftCols(N)).norm() <=
        tolerance(1e-8, "two residuals of 1e-10 over a condition of tens") * u.norm());
  for (int n = 0; n < N; ++n) {
    if (half.mesh.nodes(0, n) == 0.0) CHECK(u(0, n) == 0.0);
  }
  // The search for a load respects the symmetry plane, too.
  const LoadSearch found = EquilibriumSolver(half).find_load(load / 8, 0.004);
  CHECK(found.reached);
}

TEST_CASE("a load along held directions only is refused", "[solid][supports][errors]") {
  SolidModel model = cube("neo-hookean", 2);
  hold_plane(model, 0, kSide);
  const EquilibriumSolver solver(model);
  Matrix3Xd load = Matrix3Xd::Zero(3, model.mesh.node_count());
  load(0, model.supports.back().node) = 1.0;
  CHECK_THROWS_WITH(solver.solve_path(load, std::array{1.0}), Contains("fixed nodes only"));
  load(1, model.supports.back().node) = 1.0;
  CHECK(solver.solve_path(load, std::array{1.0}).complete);
}

TEST_CASE("a body cannot be crushed beyond zero height", "[solid][path]") {
  // The whole surface follows z -> (1 - 1.25 level) z, which inverts everything at level 0.8.
  SolidModel model = cube("neo-hookean", 3);
  model.fixed_nodes.clear();
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    const Vector3d X = model.mesh.nodes.col(n);
    if ((X.array() == 0.0).any() || (X.array() == kSide).any()) model.fixed_nodes.push_back(n);
  }
  model.fixed_displacement =
      Vector3d(0, 0, -1.25).asDiagonal() * model.mesh.nodes(Eigen::all, model.fixed_nodes);
  const Matrix3Xd none = Matrix3Xd::Zero(3, model.mesh.node_count());
  const std::array levels{0.2, 0.4, 0.6, 0.78, 0.9};
  const PathResult path = EquilibriumSolver(model).solve_path(none, levels);
  CHECK_FALSE(path.complete);
  REQUIRE(path.steps.size() == 4);
  CHECK(path.steps.back().smallest_volume_ratio == Approx(1 - 1.25 * 0.78));
  CHECK(path.stop == Stop::kInversion);
  CHECK_THAT(path.why_stopped, Contains("level 0.9") && Contains("inside out"));
}

TEST_CASE("a load that cannot move the body is refused", "[solid][errors]") {
  SolidModel model = cube("neo-hookean", 3);
  const EquilibriumSolver solver(model);
  const std::array levels{1.0};
  Matrix3Xd load = Matrix3Xd::Zero(3, model.mesh.node_count());
  CHECK_THROWS_WITH(solver.solve_path(load, levels), Contains("load is zero"));
  load.col(model.fixed_nodes.front()) = Vector3d(0, 0, 1);
  CHECK_THROWS_WITH(solver.solve_path(load, levels), Contains("fixed nodes only"));
  CHECK_THROWS_WITH(solver.find_load(load, 0.01), Contains("fixed nodes only"));
  load(0, 1) = std::nan("");
  CHECK_THROWS_WITH(solver.solve_path(load, levels), Contains("not finite"));
}

TEST_CASE("misuse of the solver is a contract violation", "[solid][errors]") {
  const SolidModel model = cube("neo-hookean", 2);
  const EquilibriumSolver solver(model);
  const Matrix3Xd load = press_at(model, kTop);
  CHECK_THROWS_AS(solver.solve_path(load.leftCols(3), std::array{1.0}), ContractViolation);
  CHECK_THROWS_AS(solver.solve_path(load, std::array{0.0}), ContractViolation);
  CHECK_THROWS_AS(solver.solve_path(load, std::array{0.5, 0.5}), ContractViolation);
  CHECK_THROWS_AS(solver.find_load(load, -1.0), ContractViolation);
}

TEST_CASE("a model that cannot be solved is refused when the solver is made", "[solid][errors]") {
  SolidModel model = cube("neo-hookean", 2);
  model.fixed_nodes.clear();
  CHECK_THROWS_AS(EquilibriumSolver(model), Error);
  for (int n = 0; n < model.mesh.node_count(); ++n) model.fixed_nodes.push_back(n);
  CHECK_THROWS_WITH(EquilibriumSolver(model), Contains("every node"));

  // Two tetrahedra that share one edge: a hinge, though each node belongs to one body.
  SolidModel hinge;
  hinge.material = model.material;
  hinge.mesh.nodes.resize(3, 6);
  hinge.mesh.nodes << 0, 1, 0, 0, 0, 0,  //
      0, 0, 1, 0, -1, 0,                 //
      0, 0, 0, 1, 0, -1;
  hinge.mesh.tets.resize(4, 2);
  hinge.mesh.tets.col(0) << 0, 1, 2, 3;
  hinge.mesh.tets.col(1) << 0, 1, 4, 5;
  hinge.fixed_nodes = {0, 1, 2, 3};
  REQUIRE_NOTHROW(check_model(hinge));
  CHECK_THROWS_WITH(EquilibriumSolver(hinge), Contains("without resistance"));
}

TEST_CASE("a solve starts no threads of its own", "[solid][path]") {
  // Linux: one entry per thread of this process.
  const auto threads = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"),
                         std::filesystem::directory_iterator());
  };
  const auto before = threads();
  const SolidModel model = cube();
  const EquilibriumSolver solver(model);
  CHECK(solver.solve_path(press_at(model, kTop), std::array{1.0}).complete);
  CHECK(threads() == before);
}

TEST_CASE("sites solved side by side have exactly the states of sites solved in turn",
          "[solid][threads]") {
  const SolidModel model = cube("neo-hookean", 4);
  const EquilibriumSolver solver(model);
  const std::array sites{kTop, kEdge, Vector3d(kSide, kSide / 2, kSide / 2)};
  const std::array levels{0.25, 0.5, 0.75, 1.0};
  std::array<LoadSearch, 3> found_in_turn, found;
  std::array<PathResult, 3> in_turn, at_once;
  const auto solve = [&](std::size_t k, LoadSearch& search, PathResult& path) {
    const Matrix3Xd unit = press_at(model, sites[k]);
    search = solver.find_load(unit, 0.012);
    path = solver.solve_path(search.load * unit, levels);
  };
  for (std::size_t k = 0; k < 3; ++k) solve(k, found_in_turn[k], in_turn[k]);
  {
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < 3; ++k) {
      threads.emplace_back([&, k] { solve(k, found[k], at_once[k]); });
    }
    for (std::thread& thread : threads) thread.join();
  }
  for (std::size_t k = 0; k < 3; ++k) {
    REQUIRE((in_turn[k].complete && at_once[k].complete));
    CHECK(found[k].load == found_in_turn[k].load);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      CHECK(in_turn[k].steps[i].displacement == at_once[k].steps[i].displacement);
    }
  }
}

TEST_CASE("a slender, nearly incompressible beam of 10-node tetrahedra bends to the end",
          "[solid][path]") {
  // The stiffnesses of bending and of compression differ by more than the 8 bits of a factor can
  // hold.
  SolidModel model;
  model.mesh = with_edge_nodes(box_tets({0, 0, 0}, {1.0, 0.02, 0.01}, 60, 1, 1));
  model.material = material_from_young("neo-hookean", 60e3, 0.49);
  std::vector<int> tip;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(0, n) == 0.0) model.fixed_nodes.push_back(n);
    if (model.mesh.nodes(0, n) == 1.0) tip.push_back(n);
  }
  const double EI = 60e3 * 0.02 * std::pow(0.01, 3) / 12;
  const std::vector<double> weights(tip.size(), 1.0);
  const Matrix3Xd load = EI * patch_force(model.mesh.node_count(), tip, weights, {0, 0, -1});
  const PathResult path =
      EquilibriumSolver(model).solve_path(load, std::vector<double>{0.25, 0.5, 0.75, 1.0});
  INFO(path.why_stopped);
  REQUIRE(path.complete);
  // The elastica under P L^2 / EI = 1 (docs/verification.md).
  CHECK(-path.steps.back().displacement(2, tip.front()) ==
        Approx(0.30172).epsilon(tolerance(0.03, "one element over the height")));
}

TEST_CASE("a press of a millionth of the height is solved as any other", "[solid][path]") {
  // The energy is smaller than its rounding error: the line search must not take that for an
  // increase.
  for (const std::string& law : law_names()) {
    const SolidModel model = cube(law);
    const EquilibriumSolver solver(model);
    const Matrix3Xd load = press_at(model, kTop);
    for (const double level : {1e-7, 1e-5, 1e-3}) {
      const PathResult path = solver.solve_path(load, std::vector<double>{level});
      INFO(law << ", level " << level << ": " << path.why_stopped);
      CHECK(path.complete);
    }
  }
}

}  // namespace
}  // namespace palpable
