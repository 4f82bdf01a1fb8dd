#include "palpable/bake/campaign.h"

#include "palpable/bake/contact_sites.h"
#include "palpable/base/error.h"
#include "palpable/solid/stress.h"
#include "tests/support/test.h"

#include <mutex>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using test::tolerance;

// A block of rubber that stands on the ground.
struct Block {
  TetMesh mesh = box_tets({-0.03, -0.02, 0}, {0.03, 0.02, 0.05}, 4, 3, 4);
  Boundary boundary = boundary_of(mesh);
  EquilibriumSolver solver;
  std::vector<Site> sites;

  explicit Block(const char* law = "neo-hookean") : solver(model(law)) {
    std::vector<std::uint8_t> fixed;
    for (const auto& x : boundary.surface.vertices.colwise()) fixed.push_back(x[2] < 0.001);
    sites =
        choose_sites(boundary.surface, fixed, {.count = 3, .lowest = 0.02, .patch_distance = 1});
  }
  [[nodiscard]] SolidModel model(const char* law) const {
    SolidModel model{.mesh = mesh,
                     .material = material_from_young(law, 60e3, 0.4),
                     .fixed_nodes = {},
                     .fixed_displacement = {}};
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
    }
    return model;
  }
  [[nodiscard]] Campaign run(double press, int threads, const Progress& progress = {}) const {
    return run_campaign(solver, boundary, sites, {.press = press, .levels = 4, .threads = threads},
                        progress);
  }
};

TEST_CASE("each site gives way by the press at its full load, in steps that only grow",
          "[bake][campaign]") {
  const Block block;
  const double press = 0.004;
  const Campaign campaign = block.run(press, 1);
  REQUIRE(campaign.sites.size() == 3);
  CHECK(campaign.levels == Eigen::VectorXd::LinSpaced(5, 0.0, 1.0));
  for (Eigen::Index s = 0; s < 3; ++s) {
    INFO("site " << s);
    const Site& site = campaign.sites[std::size_t(s)];
    CHECK(campaign.outcomes[std::size_t(s)].reached_press);
    CHECK(site.full_load > 0.0);
    CHECK(campaign.press_depth(0, s) == 0.0);
    CHECK(std::abs(campaign.press_depth(4, s) - press) <=
          tolerance(1e-3, "the search of the load") * press);
    for (Eigen::Index l = 0; l < 4; ++l) {
      CHECK(campaign.press_depth(l + 1, s) > campaign.press_depth(l, s));
      // What the table says is the weighted displacement of the patch along the load.
      const Eigen::VectorXd u = campaign.displacement.values.col(s * 4 + l);
      double depth = 0;
      for (std::size_t k = 0; k < site.patch.size(); ++k) {
        const int node = block.boundary.node_of_vertex[std::size_t(site.patch[k])];
        depth += static_cast<double>(site.weights[k]) * site.direction.dot(u.segment<3>(3 * node));
      }
      CHECK(std::abs(depth - campaign.press_depth(l + 1, s)) <=
            tolerance(1e-6, "weights are single precision") * press);
    }
  }
}

TEST_CASE("every snapshot is in equilibrium with its load", "[bake][campaign]") {
  const Block block;
  const Campaign campaign = block.run(0.004, 1);
  for (Eigen::Index k = 0; k < campaign.displacement.values.cols(); ++k) {
    INFO("snapshot " << k);
    const Eigen::Matrix3Xd u =
        campaign.displacement.values.col(k).reshaped(3, block.mesh.node_count());
    const Eigen::Matrix3Xd force = block.solver.internal_force(u);
    const Site& site = campaign.sites[std::size_t(k / 4)];
    const double load = site.full_load * static_cast<double>(k % 4 + 1) / 4.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // over free nodes: the load and nothing else
    for (int n = 0; n < block.mesh.node_count(); ++n) {
      if (block.mesh.nodes(2, n) >= 0.001) sum += force.col(n);
    }
    CHECK((sum - load * site.direction).norm() <=
          tolerance(1e-5, "the solver's tolerance, summed over nodes") * load);
    const StressField stress = nodal_cauchy_stress(block.solver.model(), u);
    CHECK(campaign.stress.values.col(k) == Eigen::VectorXd(stress.reshaped()));
  }
}

TEST_CASE("the colour scale ends at the largest von Mises stress of the skin", "[bake][campaign]") {
  const Block block;
  const Campaign campaign = block.run(0.004, 1);
  double largest = 0;
  for (Eigen::Index k = 0; k < campaign.stress.values.cols(); ++k) {
    for (const int node : block.boundary.node_of_vertex) {
      const auto s = campaign.stress.values.col(k).segment<6>(6 * node);
      const double v = std::sqrt(
          0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
          3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
      largest = std::max(largest, v);
    }
  }
  CHECK(std::abs(campaign.largest_von_mises - largest) <= tolerance(1e-9, "rounding") * largest);
}

TEST_CASE("the campaign is the same on one thread and on five", "[bake][campaign][threads]") {
  const Block block;
  const Campaign one = block.run(0.004, 1), five = block.run(0.004, 5);
  CHECK(one.displacement.values == five.displacement.values);
  CHECK(one.stress.values == five.stress.values);
  CHECK(one.press_depth == five.press_depth);
}

TEST_CASE("progress is reported one at a time and reaches the end", "[bake][campaign][threads]") {
  const Block block;
  std::mutex only_one;
  std::string task;
  double done = 0;
  int ends = 0;
  const auto listen = [&](const ProgressReport& r) {
    const std::unique_lock lock(only_one, std::try_to_lock);
    CHECK(lock.owns_lock());
    if (r.task != task) done = 0;
    task = r.task;
    CHECK(r.done >= done);
    CHECK(r.total == 3.0);
    done = r.done;
    ends += r.done == r.total;
  };
  (void)block.run(0.003, 3, listen);
  CHECK(ends == 2);  // finding loads, solving sites
}

TEST_CASE("a press that no load reaches is refused", "[bake][campaign]") {
  // St. Venant-Kirchhoff's law softens in compression until it collapses.
  CHECK_THROWS_WITH(Block("saint-venant-kirchhoff").run(0.04, 2),
                    Contains("ask for a smaller press"));
}

}  // namespace
}  // namespace palpable
