// Our solver and CalculiX on the same meshes, laws and loads, each solved to 1e-8.
#include "bench/bake/calculix_comparison.h"

#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/describe/contact_sites.h"
#include "palpable/bake/mesh/tetrahedralise.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/loads.h"
#include "tests/support/test.h"
#include "tests/verification/record.h"
#include "tests/verification/shapes.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

constexpr const char* kNoCalculix = "CalculiX (ccx, Debian calculix-ccx) is not installed";

std::vector<double> even_levels(int count) {
  std::vector<double> levels;
  for (int k = 1; k <= count; ++k) levels.push_back(static_cast<double>(k) / count);
  return levels;
}

// Solves with both programs and compares every level.
void compare(const std::string& body, const SolidModel& model, const Matrix3Xd& load,
             const std::vector<double>& levels) {
  const PathResult ours = EquilibriumSolver(model).solve_path(load, levels);
  INFO(body << ": " << ours.why_stopped);
  REQUIRE(ours.complete);
  const CalculixRun theirs = solve_with_calculix(model, load, levels);
  INFO(theirs.why_stopped);
  REQUIRE(theirs.complete);

  const PathDifference difference = compare_paths(model, ours, theirs);
  CHECK(difference.levels == static_cast<int>(levels.size()));
  CHECK(difference.displacement <=
        tolerance(kDisplacementLimit, "issue 4; both solved to 1e-8, ccx prints seven digits"));
  CHECK(difference.stress <=
        tolerance(kStressLimit, "issue 4; both solved to 1e-8, ccx prints seven digits"));
  test::record(
      "calculix",
      {{"body", body},
       {"law", law_name(model.material)},
       {"nodes", std::to_string(model.mesh.node_count())},
       {"tets",
        fmt::format("{} {}", model.mesh.tet_count(), model.mesh.is_quadratic() ? "C3D10" : "C3D4")},
       {"levels", std::to_string(levels.size())},
       {"largest displacement", fmt::format("{:.3g} mm", 1e3 * difference.largest_displacement)},
       {"smallest J", fmt::format("{:.2f}", difference.smallest_volume_ratio)},
       {"difference of u", fmt::format("{:.1e}", difference.displacement)},
       {"difference of stress", fmt::format("{:.1e}", difference.stress)}});
}

// A beam that bends in both directions and twists: its tip load is not parallel to an axis.
void compare_beam(const std::string& name, TetMesh mesh, const std::vector<MaterialGroup>& groups) {
  const double L = 0.3, h = 0.02, b = 0.03, E = 1e6;
  SolidModel model;
  model.mesh = std::move(mesh);
  model.material = material_from_young("saint-venant-kirchhoff", E, 0.3);
  model.groups = groups;
  std::vector<int> tip;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(0, n) == 0.0) model.fixed_nodes.push_back(n);
    if (model.mesh.nodes(0, n) > L - 1e-9) tip.push_back(n);
  }
  const std::vector<double> weights(tip.size(), 1.0);
  const double EI = E * b * h * h * h / 12;
  const Matrix3Xd load =
      3.0 * EI / (L * L) * patch_force(model.mesh.node_count(), tip, weights, {0.1, 0.5, -1.0});
  compare(name, model, load, even_levels(10));
}

TEST_CASE("CalculiX bends a St. Venant-Kirchhoff beam as we do, at every level",
          "[verification][calculix][long]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  compare_beam("beam, tip load", box_tets({0, 0, 0}, {0.3, 0.03, 0.02}, 30, 3, 3), {});
}

TEST_CASE("CalculiX bends a beam of ten-node tetrahedra as we do, at every level",
          "[verification][calculix][long]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  compare_beam("beam, tip load", with_edge_nodes(box_tets({0, 0, 0}, {0.3, 0.03, 0.02}, 15, 2, 1)),
               {});
}

TEST_CASE("CalculiX bends a beam of two materials as we do, at every level",
          "[verification][calculix][long]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  const TetMesh mesh = box_tets({0, 0, 0}, {0.3, 0.03, 0.02}, 24, 2, 2);
  MaterialGroup soft{.material = material_from_young("neo-hooke-abaqus", 0.4e6, 0.4),
                     .elements = {}};
  for (int e = 0; e < mesh.tet_count(); e += 3) soft.elements.push_back(e);
  compare_beam("beam of two materials, tip load", mesh, {soft});
}

TEST_CASE("CalculiX presses a neo-Hookean ball with ears as we do, at every level",
          "[verification][calculix][long]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  SolidModel model;
  model.mesh = tetrahedralise(test::ball_with_ears(3), "ball with ears");
  model.material = material_from_young("neo-hooke-abaqus", 70e3, 0.3);
  const double bottom = model.mesh.nodes.row(2).minCoeff(),
               top = model.mesh.nodes.row(2).maxCoeff();
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) < bottom + 0.1 * (top - bottom)) model.fixed_nodes.push_back(n);
  }
  const Boundary skin = boundary_of(model.mesh);
  std::vector<std::uint8_t> fixed(skin.node_of_vertex.size());
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    fixed[v] = model.mesh.nodes(2, skin.node_of_vertex[v]) < bottom + 0.1 * (top - bottom);
  }
  const EquilibriumSolver solver(model);
  int number = 0;
  for (const Site& site :
       choose_sites(skin.surface, fixed, {.count = 1, .lowest = bottom + 0.03})) {
    std::vector<int> nodes;
    for (const int v : site.patch) nodes.push_back(skin.node_of_vertex[v]);
    const std::vector<double> weights(site.weights.begin(), site.weights.end());
    const Matrix3Xd unit =
        patch_force(model.mesh.node_count(), nodes, weights, site.direction.cast<double>());
    const LoadSearch search = solver.find_load(unit, 0.08 * (top - bottom));
    INFO(search.why_stopped);
    REQUIRE(search.load > 0.0);
    const double share = search.reached ? 1.0 : 0.95;
    compare(fmt::format("ball with ears, site {}, pressed by {:.1f} %", number++,
                        100 * share * search.press / (top - bottom)),
            model, share * search.load * unit, even_levels(10));
  }
}

TEST_CASE("CalculiX presses a coarse neo-Hookean bunny as we do, at every level",
          "[verification][calculix][long]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  std::filesystem::path file = "build/meshes/bunny.off";  // tools/setup.sh fetches it
  if (!std::filesystem::exists(file)) file = "../shared/data/meshes/npm_bunny.off";
  if (!std::filesystem::exists(file)) {
    PALPABLE_SKIP(
        "no bunny: neither build/meshes/bunny.off nor ../shared/data/meshes/npm_bunny.off");
  }
  BodyDescription description;
  description.name = "bunny";
  description.shape = {.file = file, .up = UpAxis::kY, .height = 0.1, .edge = 0.0075};
  const BodyMesh body = make_body_mesh(description);
  SolidModel model;
  model.mesh = body.mesh;
  model.material = material_from_young("neo-hooke-abaqus", 70e3, 0.3);
  model.fixed_nodes = body.fixed_nodes;
  std::vector<std::uint8_t> held(body.mesh.node_count());
  for (const int n : body.fixed_nodes) held[n] = 1;
  std::vector<std::uint8_t> fixed;
  for (const int n : body.boundary.node_of_vertex) fixed.push_back(held[n]);
  const EquilibriumSolver solver(model);
  int number = 0;
  for (const Site& site :
       choose_sites(body.boundary.surface, fixed, {.count = 2, .lowest = 0.01})) {
    std::vector<int> nodes;
    for (const int v : site.patch) { nodes.push_back(body.boundary.node_of_vertex[v]); }
    const std::vector<double> weights(site.weights.begin(), site.weights.end());
    const Matrix3Xd unit =
        patch_force(model.mesh.node_count(), nodes, weights, site.direction.cast<double>());
    const LoadSearch search = solver.find_load(unit, 0.1 * body.height);
    INFO(search.why_stopped);
    REQUIRE(search.load > 0.0);
    const double share = search.reached ? 1.0 : 0.95;
    compare(fmt::format("bunny, site {}, pressed by {:.1f} %", number++,
                        100 * share * search.press / body.height),
            model, share * search.load * unit, even_levels(10));
  }
}

// Axial force per undeformed area of a unit cube whose surface is displaced to diag(s, 1, 1) X.
struct Reactions {
  double ours, calculix;
};
Reactions uniaxial_strain(const Material& material, double s) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {1, 1, 1}, 2, 2, 2);
  model.material = material;
  // Only the central node is free.
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes.col(n) != Vector3d(0.5, 0.5, 0.5)) model.fixed_nodes.push_back(n);
  }
  model.fixed_displacement =
      Vector3d(s - 1, 0, 0).asDiagonal() * model.mesh.nodes(Eigen::all, model.fixed_nodes);
  const Matrix3Xd none = Matrix3Xd::Zero(3, model.mesh.node_count());
  const std::array full{1.0};
  const EquilibriumSolver solver(model);
  const PathResult path = solver.solve_path(none, full);
  REQUIRE(path.complete);
  const Matrix3Xd force = solver.internal_force(path.steps.back().displacement);
  double ours = 0;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(0, n) == 1.0) ours += force(0, n);
  }
  // The cross section does not change, so that the uniform Cauchy stress xx equals
  // the force per area.
  const CalculixRun run = solve_with_calculix(model, none, full);
  REQUIRE(run.complete);
  const StressField& stress = run.states.back().stress;
  CHECK(stress.row(0).maxCoeff() - stress.row(0).minCoeff() <=
        tolerance(2e-6, "seven printed digits") * stress.row(0).mean());
  return {ours, stress.row(0).mean()};
}

TEST_CASE(
    "a cube stretched by half in uniaxial strain pulls in both programs as the closed forms say",
    "[verification][calculix][closed-form][long]") {
  if (!find_calculix()) PALPABLE_SKIP(kNoCalculix);
  const double E = 1000, nu = 0.3, s = 1.5;
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  // The Abaqus form with C10 = 200, D1 = 0.001: d/ds of C10 (s^(4/3) + 2 s^(-2/3) - 3) + (s - 1)^2
  // / D1
  const NeoHookeanAbaqus rubber{.C10 = 200, .D1 = 0.001};
  const struct {
    Material material;
    double closed_form;  // P11
    double known;        // data README, to its digits
  } cases[] = {
      {SaintVenantKirchhoff{.lambda = lambda, .mu = mu}, 0.5 * (lambda + 2 * mu) * (s * s * s - s),
       1262.019},
      {rubber,
       rubber.C10 * 4 / 3 * (std::cbrt(s) - std::pow(s, -5.0 / 3)) + 2 * (s - 1) / rubber.D1,
       1169.587},
  };
  for (const auto& c : cases) {
    const std::string law = law_name(c.material);
    INFO(law);
    const Reactions reactions = uniaxial_strain(c.material, s);
    CHECK(c.closed_form == Approx(c.known).margin(tolerance(5e-4, "digits")));
    CHECK(reactions.ours == Approx(c.closed_form).epsilon(tolerance(1e-9, "solved to 1e-8")));
    CHECK(reactions.calculix ==
          Approx(c.closed_form).epsilon(tolerance(1e-6, "seven printed digits")));
    test::record("uniaxial", {{"law", law},
                              {"closed form", fmt::format("{:.3f}", c.closed_form)},
                              {"ours", fmt::format("{:.3f}", reactions.ours)},
                              {"CalculiX", fmt::format("{:.3f}", reactions.calculix)}});
  }
}

}  // namespace
}  // namespace palpable
