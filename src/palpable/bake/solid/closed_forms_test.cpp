// The solver against solutions that are known: the patch tests, uniaxial strain, beam theory.
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/stress.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

constexpr std::array kFull{1.0};

bool on_box_surface(const Vector3d& X) {
  return (X.array() == 0.0).any() || (X.array() == 1.0).any();
}

// A unit cube whose inner nodes are moved at random by up to a quarter of the mesh size.
TetMesh distorted_cube(int cells) {
  TetMesh mesh = box_tets({0, 0, 0}, {1, 1, 1}, cells, cells, cells);
  auto random = test::random_case(5);
  std::uniform_real_distribution<double> shift(-0.25 / cells, 0.25 / cells);
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (on_box_surface(mesh.nodes.col(n))) continue;
    for (int i = 0; i < 3; ++i) mesh.nodes(i, n) += shift(random);
  }
  return mesh;
}

// Everything on the surface is moved to F X.
SolidModel held_all_around(TetMesh mesh, const Material& material, const Matrix3d& F) {
  SolidModel model;
  model.mesh = std::move(mesh);
  model.material = material;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (on_box_surface(model.mesh.nodes.col(n))) model.fixed_nodes.push_back(n);
  }
  model.fixed_displacement =
      (F - Matrix3d::Identity()) * model.mesh.nodes(Eigen::all, model.fixed_nodes);
  return model;
}

const Matrix3d& large_deformation() {
  static const Matrix3d F = (Matrix3d() << 1.25, 0.2, 0.0,  //
                             -0.1, 0.85, 0.15,              //
                             0.05, 0.0, 1.1)
                                .finished();
  return F;
}

TEST_CASE("a linear displacement of the surface is reproduced exactly inside a distorted mesh",
          "[solid][patch-test]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const Matrix3d& F = large_deformation();
    const SolidModel model =
        held_all_around(distorted_cube(4), material_from_young(law, 1000, 0.4), F);
    const EquilibriumSolver solver(model, {.tolerance = 1e-12});
    const Matrix3Xd none = Matrix3Xd::Zero(3, model.mesh.node_count());
    const PathResult path = solver.solve_path(none, kFull);
    REQUIRE(path.complete);
    const Matrix3Xd exact = (F - Matrix3d::Identity()) * model.mesh.nodes;
    CHECK((path.steps.back().displacement - exact).cwiseAbs().maxCoeff() <=
          tolerance(1e-11, "residual of 1e-12 over a condition of tens"));
  }
}

TEST_CASE("a uniform traction on a distorted mesh held at three nodes gives a uniform stress",
          "[solid][patch-test]") {
  const Matrix3d& F = large_deformation();
  for (const std::string& law : law_names()) {
    INFO(law);
    SolidModel model;
    model.mesh = distorted_cube(3);
    model.material = material_from_young(law, 1000, 0.3);
    model.fixed_nodes = {0, 3, 12};  // the corner (0, 0, 0) and its neighbours along x and y
    REQUIRE(model.mesh.nodes.col(3) == Vector3d(1, 0, 0));
    REQUIRE(model.mesh.nodes.col(12) == Vector3d(0, 1, 0));
    model.fixed_displacement =
        (F - Matrix3d::Identity()) * model.mesh.nodes(Eigen::all, model.fixed_nodes);

    // Dead traction t = P N on every face, a third of it to each corner.
    const Matrix3d P = first_piola(model.material, F);
    const Boundary skin = boundary_of(model.mesh);
    Matrix3Xd load = Matrix3Xd::Zero(3, model.mesh.node_count());
    for (Eigen::Index t = 0; t < skin.surface.triangles.cols(); ++t) {
      const Eigen::Vector3i v = skin.surface.triangles.col(t);
      const auto& X = skin.surface.vertices;
      const Vector3d area_normal =
          0.5 * Vector3d(X.col(v[1]) - X.col(v[0])).cross(Vector3d(X.col(v[2]) - X.col(v[0])));
      for (const int k : v) { load.col(skin.node_of_vertex[k]) += P * area_normal / 3.0; }
    }

    const EquilibriumSolver solver(model, {.tolerance = 1e-12});
    const std::array levels{0.25, 0.5, 0.75, 1.0};  // in between the state is not uniform
    const PathResult path = solver.solve_path(load, levels);
    INFO(path.why_stopped);
    REQUIRE(path.complete);
    const Matrix3Xd exact = (F - Matrix3d::Identity()) * model.mesh.nodes;
    CHECK((path.steps.back().displacement - exact).cwiseAbs().maxCoeff() <=
          tolerance(1e-10, "residual of 1e-12 over a condition of hundreds"));
    const Matrix3d sigma = P * F.transpose() / F.determinant();
    const StressField stress = nodal_cauchy_stress(model, path.steps.back().displacement);
    CHECK((stress.row(0).array() - sigma(0, 0)).abs().maxCoeff() <=
          tolerance(1e-7, "the displacement's error times E = 1000"));
  }
}

// Axial force per undeformed area on the face x = 1 of a cube stretched to s with its sides held.
double uniaxial_reaction(const std::string& law, double s) {
  const Matrix3d F = Vector3d(s, 1, 1).asDiagonal();
  const SolidModel model = held_all_around(box_tets({0, 0, 0}, {1, 1, 1}, 3, 3, 3),
                                           material_from_young(law, 1000, 0.3), F);
  const EquilibriumSolver solver(model, {.tolerance = 1e-12});
  const Matrix3Xd none = Matrix3Xd::Zero(3, model.mesh.node_count());
  const PathResult path = solver.solve_path(none, kFull);
  REQUIRE(path.complete);
  const Matrix3Xd force = solver.internal_force(path.steps.back().displacement);
  double sum = 0.0;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(0, n) == 1.0) sum += force(0, n);
  }
  return sum;
}

TEST_CASE("a cube in uniaxial strain pulls back as the closed form says", "[solid][closed-form]") {
  const double lambda = 1000 * 0.3 / (1.3 * 0.4), mu = 1000 / 2.6;
  const double rounding = tolerance(1e-9, "sums of 100 forces of order 100 N");
  // St. Venant-Kirchhoff: P11 = (lambda + 2 mu) / 2 (s^3 - s)
  CHECK(uniaxial_reaction("saint-venant-kirchhoff", 1.5) ==
        Approx(1262.019).margin(tolerance(5e-4, "digits printed")));
  CHECK(uniaxial_reaction("saint-venant-kirchhoff", 0.8) ==
        Approx(0.5 * (lambda + 2 * mu) * (0.512 - 0.8)).margin(rounding));
  // neo-Hookean: P11 = mu (s - 1/s) + lambda ln(s) / s
  for (const double s : {1.5, 0.5}) {
    CHECK(uniaxial_reaction("neo-hookean", s) ==
          Approx(mu * (s - 1 / s) + lambda * std::log(s) / s).margin(rounding));
  }
}

// Tip deflection of a cantilever of 1 x 0.1 x 0.1 m over that of Timoshenko's theory, small load.
double tip_over_timoshenko(int cells_across, double nu) {
  const double L = 1.0, h = 0.1, E = 1e6, P = 1e-3;
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {L, h, h}, 5 * cells_across, cells_across, cells_across);
  model.material = material_from_young("saint-venant-kirchhoff", E, nu);
  std::vector<int> tip;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(0, n) == 0.0) model.fixed_nodes.push_back(n);
    if (model.mesh.nodes(0, n) == L) tip.push_back(n);
  }
  const std::vector<double> weights(tip.size(), 1.0);
  const Matrix3Xd f = patch_force(model.mesh.node_count(), tip, weights, {0, 0, -1});
  const PathResult path = EquilibriumSolver(model).solve_path(P * f, kFull);
  REQUIRE(path.complete);
  const double press = f.cwiseProduct(path.steps.back().displacement).sum();
  const double I = std::pow(h, 4) / 12, G = E / (2 * (1 + nu));
  const double kappa = 10 * (1 + nu) / (12 + 11 * nu);  // Cowper's shear factor of a rectangle
  return press / (P * L * L * L / (3 * E * I) + P * L / (kappa * G * h * h));
}

// Linear tetrahedra cannot bend, so a mesh is too stiff: stiffness = s (1 + c h^2 + ...), with h
// the mesh size and s the true one. Two meshes of sizes 2 h and h give s.
double extrapolated_stiffness(double coarse, double fine) { return (4 / fine - 1 / coarse) / 3; }

TEST_CASE("a cantilever of linear tetrahedra is too stiff, and refining it leads to beam theory",
          "[solid][closed-form]") {
  // nu = 0, so that the clamp does not hinder the cross section and beam theory is exact enough.
  const double two = tip_over_timoshenko(2, 0.0), four = tip_over_timoshenko(4, 0.0);
  INFO("deflection over Timoshenko's: " << two << " with 2 cells across, " << four << " with 4");
  CHECK(two < four);
  CHECK(four < 1.0);
  // Measured: with four cells across, twice as long as high, a third of the deflection is missing.
  CHECK(four == Approx(0.671).margin(0.002));
  CHECK((1 / two - 1) / (1 / four - 1) ==
        Approx(4.0).margin(tolerance(0.2, "terms of order h^4 with h = half the height")));
  CHECK(extrapolated_stiffness(two, four) ==
        Approx(1.0).margin(tolerance(0.03, "terms of order h^4 with h = half the height")));
}

TEST_CASE("a cantilever with eight cells across is an eighth too stiff, its extrapolation is not",
          "[solid][closed-form][long]") {
  const double four = tip_over_timoshenko(4, 0.3), eight = tip_over_timoshenko(8, 0.3);
  INFO("deflection over Timoshenko's: " << four << " with 4 cells across, " << eight << " with 8");
  CHECK(eight == Approx(0.883).margin(0.002));
  CHECK(extrapolated_stiffness(four, eight) ==
        Approx(1.0).margin(tolerance(
            0.02, "the clamp hinders the cross section, which beam theory leaves out; h^4")));
}

}  // namespace
}  // namespace palpable
