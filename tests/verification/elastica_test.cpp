// The elastica: a slender cantilever that bends far under a dead load at its tip.
#include "palpable/solid/equilibrium.h"
#include "tests/support/test.h"
#include "tests/verification/record.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using test::tolerance;

// Wider than high: a beam that is bent about its stiff axis would escape to the side.
constexpr double kLength = 1.0, kHeight = 0.05, kWidth = 0.1, kYoung = 1e9;

struct Row {
  double k;     // P L^2 / (E I)
  double w, u;  // deflection and shortening over L, of an inextensible beam without shear
};
// The elliptic integrals' values; data README.
constexpr std::array kElastica{Row{1, 0.30172, 0.05643}, Row{2, 0.49346, 0.16064},
                               Row{3, 0.60325, 0.25442}, Row{5, 0.71379, 0.38763},
                               Row{10, 0.81061, 0.55500}};

struct Tip {
  double w, u;
};

// Mean displacement of the end face at the loads of the table, with `cells` cells over the height.
std::array<Tip, 5> bend(int cells, int* nodes) {
  SolidModel model;
  const int along = static_cast<int>(std::lround(cells * kLength / kHeight));
  model.mesh = box_tets({0, 0, 0}, {kLength, kWidth, kHeight}, along, cells, cells);
  // nu = 0: the cross section keeps its shape, so that beam theory has nothing to neglect there.
  model.material = material_from_young("saint-venant-kirchhoff", kYoung, 0.0);
  const double I = kWidth * std::pow(kHeight, 3) / 12;
  std::vector<int> tip;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(0, n) == 0.0) model.fixed_nodes.push_back(n);
    if (model.mesh.nodes(0, n) > kLength - 1e-9) tip.push_back(n);
  }
  *nodes = model.mesh.node_count();
  // Shear spread evenly over the end face; its parabola dies out within a height.
  Matrix3Xd load = Matrix3Xd::Zero(3, model.mesh.node_count());
  Eigen::VectorXd share = Eigen::VectorXd::Zero(model.mesh.node_count());
  const Boundary skin = boundary_of(model.mesh);
  const Eigen::VectorXd areas = vertex_areas(skin.surface);
  for (Eigen::Index t = 0; t < skin.surface.triangles.cols(); ++t) {
    Eigen::Vector3i v = skin.surface.triangles.col(t);
    for (int& k : v) k = skin.node_of_vertex[static_cast<std::size_t>(k)];
    if ((model.mesh.nodes(0, v).array() < kLength - 1e-9).any()) continue;
    for (const int n : v) share[n] += 1.0 / 3.0;  // all triangles of the face are alike
  }
  share /= share.sum();
  load.row(2) = -10.0 * kYoung * I / (kLength * kLength) * share.transpose();

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

TEST_CASE("refined linear tetrahedra tend to the elastica from the stiff side",
          "[verification][elastica][long]") {
  std::array<int, 3> nodes{};
  const std::array<int, 3> cells{3, 4, 6};
  std::array<std::array<Tip, 5>, 3> tips;
  for (std::size_t m = 0; m < 3; ++m) tips[m] = bend(cells[m], &nodes[m]);
  for (std::size_t r = 0; r < kElastica.size(); ++r) {
    const Row& row = kElastica[r];
    INFO("P L^2 / EI = " << row.k);
    // Linear tetrahedra cannot bend: each mesh is too stiff by an amount that falls with h^2.
    CHECK(tips[0][r].w < tips[1][r].w);
    CHECK(tips[1][r].w < tips[2][r].w);
    CHECK(tips[2][r].w < row.w);
    // To a mesh without size: the parabola in h^2 through the three.
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
