// The elastica: a slender cantilever with a large deflection under a dead load at its tip.
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/selection.h"
#include "tests/support/test.h"
#include "tests/verification/record.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using test::tolerance;

// Wider than high, because a beam that is bent about its stiff axis would buckle sideways.
constexpr double kLength = 1.0, kHeight = 0.05, kWidth = 0.1, kYoung = 1e9;

struct Row {
  double k;     // P L^2 / (E I)
  double w, u;  // deflection and shortening over L, of an inextensible beam without shear
};
// Values from elliptic integrals; see the data README.
constexpr std::array kElastica{Row{1, 0.30172, 0.05643}, Row{2, 0.49346, 0.16064},
                               Row{3, 0.60325, 0.25442}, Row{5, 0.71379, 0.38763},
                               Row{10, 0.81061, 0.55500}};

struct Tip {
  double w, u;
};

// Mean displacement of the end face at the loads of the table.
std::array<Tip, 5> bend(const TetMesh& mesh) {
  SolidModel model;
  model.mesh = mesh;
  // nu = 0: the cross section keeps its shape, as beam theory assumes.
  model.material = material_from_young("saint-venant-kirchhoff", kYoung, 0.0);
  const double I = kWidth * std::pow(kHeight, 3) / 12;
  model.fixed_nodes = nodes_on_plane(mesh, {0, 0, 0}, {1, 0, 0}, 1e-9);
  // Uniform shear over the end face; the difference from a parabola decays within one height.
  const Eigen::Matrix3Xi end = triangles_between(
      skin_triangles(mesh), nodes_on_plane(mesh, {kLength, 0, 0}, {1, 0, 0}, 1e-9));
  const double shear = 10.0 * kYoung * I / (kLength * kLength) / (kWidth * kHeight);
  const Matrix3Xd load =
      traction_load(mesh, end, [&](const Eigen::Vector3d&, const Eigen::Vector3d&) {
        return Eigen::Vector3d(0, 0, -shear);
      });
  const Eigen::VectorXd share = load.row(2).transpose() / load.row(2).sum();

  std::vector<double> levels;
  for (int k = 1; k <= 10; ++k) levels.push_back(k / 10.0);
  const PathResult path = EquilibriumSolver(model).solve_path(load, levels);
  INFO(path.why_stopped);
  REQUIRE(path.complete);
  std::array<Tip, 5> tips{};
  for (std::size_t r = 0; r < kElastica.size(); ++r) {
    const auto step = static_cast<std::size_t>(std::lround(kElastica[r].k)) - 1;
    const Eigen::Vector3d mean = path.steps[step].displacement * share;
    tips[r] = {-mean[2] / kLength, -mean[0] / kLength};
  }
  return tips;
}

// `cells` over the height and the width, `along` over the length.
TetMesh beam(int along, int cells) {
  return box_tets({0, 0, 0}, {kLength, kWidth, kHeight}, along, cells, cells);
}

TEST_CASE("10-node tetrahedra, one over the height, bend as the elastica does",
          "[verification][elastica][quadratic][long]") {
  const TetMesh coarse = with_edge_nodes(beam(20, 1)), fine = with_edge_nodes(beam(40, 2));
  const std::array<Tip, 5> a = bend(coarse), b = bend(fine);
  for (std::size_t r = 0; r < kElastica.size(); ++r) {
    const Row& row = kElastica[r];
    INFO("P L^2 / EI = " << row.k << ": " << a[r].w << " " << b[r].w);
    CHECK(a[r].w == Approx(row.w).epsilon(tolerance(0.006, "shear, stretching, the mesh")));
    // Shear adds 0.6 (h/L)^2 = 0.15 % to a small deflection, and stretching k (h/L)^2 / 12.
    const double off = tolerance(0.005, "shear 0.15 %, stretching 0.2 %, the mesh");
    CHECK(b[r].w == Approx(row.w).epsilon(off));
    CHECK(b[r].u == Approx(row.u).epsilon(2 * off));
    const auto percent = [](double value, double exact) {
      return fmt::format("{:+.2f} %", 100 * (value / exact - 1));
    };
    test::record("elastica-quadratic",
                 {{"P L^2/EI", fmt::format("{:g}", row.k)},
                  {"w/L", fmt::format("{:.5f}", row.w)},
                  {fmt::format("{} nodes", coarse.node_count()), percent(a[r].w, row.w)},
                  {fmt::format("{} nodes", fine.node_count()), percent(b[r].w, row.w)},
                  {"u/L", fmt::format("{:.5f}", row.u)},
                  {fmt::format("u/L, {} nodes", fine.node_count()), percent(b[r].u, row.u)}});
  }
}

TEST_CASE("refined linear tetrahedra tend to the elastica from the stiff side",
          "[verification][elastica][long]") {
  std::array<int, 3> nodes{};
  const std::array<int, 3> cells{3, 4, 6};
  std::array<std::array<Tip, 5>, 3> tips;
  for (std::size_t m = 0; m < 3; ++m) {
    const TetMesh mesh =
        beam(static_cast<int>(std::lround(cells[m] * kLength / kHeight)), cells[m]);
    nodes[m] = mesh.node_count();
    tips[m] = bend(mesh);
  }
  for (std::size_t r = 0; r < kElastica.size(); ++r) {
    const Row& row = kElastica[r];
    INFO("P L^2 / EI = " << row.k);
    // Linear tetrahedra are too stiff in bending, with an error proportional to h^2.
    CHECK(tips[0][r].w < tips[1][r].w);
    CHECK(tips[1][r].w < tips[2][r].w);
    CHECK(tips[2][r].w < row.w);
    // Extrapolation to h = 0 by the parabola in h^2 through the three values.
    const auto extrapolated = [&](auto value) {
      double sum = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        double weight = 1;
        for (std::size_t j = 0; j < 3; ++j) {
          const double xi = std::pow(cells[i], -2), xj = std::pow(cells[j], -2);
          if (j != i) weight *= xj / (xj - xi);
        }
        sum += weight * value(tips[i][r]);
      }
      return sum;
    };
    const double w = extrapolated([](const Tip& tip) { return tip.w; });
    const double u = extrapolated([](const Tip& tip) { return tip.u; });
    // Shear adds 0.6 (h/L)^2 = 0.15 % to a small deflection, and stretching k (h/L)^2 / 12.
    const double off = tolerance(0.005, "shear 0.15 %, stretching 0.2 %, the next term in h");
    CHECK(w == Approx(row.w).epsilon(off));
    CHECK(u == Approx(row.u).epsilon(2 * off));
    const auto percent = [&](double value, double exact) {
      return fmt::format("{:+.1f} %", 100 * (value / exact - 1));
    };
    test::record("elastica", {{"P L^2/EI", fmt::format("{:g}", row.k)},
                              {"w/L", fmt::format("{:.5f}", row.w)},
                              {fmt::format("{} nodes", nodes[0]), percent(tips[0][r].w, row.w)},
                              {fmt::format("{} nodes", nodes[1]), percent(tips[1][r].w, row.w)},
                              {fmt::format("{} nodes", nodes[2]), percent(tips[2][r].w, row.w)},
                              {"extrapolated w/L", fmt::format("{:.5f}", w)},
                              {"u/L", fmt::format("{:.5f}", row.u)},
                              {"extrapolated u/L", fmt::format("{:.5f}", u)}});
  }
}

}  // namespace
}  // namespace palpable
