#include "palpable/bake/campaign/site_run.h"

#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/error.h"
#include "tests/support/rubber_block.h"
#include "tests/support/solved_sites.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using test::solved_sites;
using test::SolvedSites;
using test::tolerance;

struct Block : test::RubberBlock {
  EquilibriumSolver solver;

  explicit Block(const char* law = "neo-hookean") : RubberBlock(3), solver(model(law)) {}
  [[nodiscard]] SolvedSites run(double press) const {
    return solved_sites(solver, boundary, sites, {.press = press, .levels = 4});
  }
};

TEST_CASE("each site gives way by the press at its full load, in steps that only grow",
          "[campaign][sites]") {
  const Block block;
  const double press = 0.004;
  const SolvedSites campaign = block.run(press);
  REQUIRE(campaign.sites.size() == 3);
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
      // The table holds the weighted displacement of the patch along the load.
      const Eigen::VectorXd u = campaign.displacement.col(s * 4 + l);
      double depth = 0;
      for (std::size_t k = 0; k < site.patch.size(); ++k) {
        const int node = block.boundary.node_of_vertex[std::size_t(site.patch[k])];
        depth += static_cast<double>(site.weights[k]) * site.direction.dot(u.segment<3>(3 * node));
      }
      CHECK(std::abs(depth - campaign.press_depth(l + 1, s)) <=
            tolerance(1e-6, "weights and snapshots are single precision") * press);
    }
  }
}

TEST_CASE("every snapshot is in equilibrium with its load", "[campaign][sites]") {
  const Block block;
  const SolvedSites campaign = block.run(0.004);
  for (Eigen::Index k = 0; k < campaign.displacement.cols(); ++k) {
    INFO("snapshot " << k);
    const Eigen::Matrix3Xd u = campaign.displacement.col(k).reshaped(3, block.mesh.node_count());
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
    CHECK((campaign.stress.col(k) - stress.reshaped()).cwiseAbs().maxCoeff() <=
          tolerance(1e-5, "of a displacement in single precision") * stress.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("the colour scale ends at the largest von Mises stress of the skin",
          "[campaign][sites]") {
  const Block block;
  const SolvedSites campaign = block.run(0.004);
  double largest = 0;
  for (Eigen::Index k = 0; k < campaign.stress.cols(); ++k) {
    for (const int node : block.boundary.node_of_vertex) {
      const auto s = campaign.stress.col(k).segment<6>(6 * node);
      const double v = std::sqrt(
          0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
          3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
      largest = std::max(largest, v);
    }
  }
  CHECK(std::abs(campaign.largest_von_mises - largest) <=
        tolerance(1e-6, "snapshots are single precision") * largest);
}

TEST_CASE("a force that is given is the full load of every site", "[campaign][sites]") {
  const Block block;
  const SolvedSites campaign =
      solved_sites(block.solver, block.boundary, block.sites, {.force = 1.5, .levels = 3});
  for (const Site& site : campaign.sites) CHECK(site.full_load == 1.5);
  for (const SiteOutcome& outcome : campaign.outcomes) CHECK(outcome.reached_press);
  CHECK(campaign.press_depth.row(3).minCoeff() > 0.0);
  CHECK(campaign.press_depth.row(3).maxCoeff() > 1.2 * campaign.press_depth.row(3).minCoeff());
}

TEST_CASE("a base that is moved as a whole changes no snapshot, only where the body is",
          "[campaign][sites][preload]") {
  const Block block;
  const Eigen::Vector3d step(0.001, 0.002, -0.003);
  SolidModel model = block.model("neo-hookean");
  model.fixed_displacement = step.replicate(1, static_cast<Eigen::Index>(model.fixed_nodes.size()));
  const EquilibriumSolver moved(model);
  const SiteRunSettings settings{.press = 0.004, .levels = 2};
  const Eigen::Matrix3Xd weight = gravity_load(block.mesh, 1000, {0, 0, -9.81});
  const SolvedSites a = solved_sites(block.solver, block.boundary, block.sites, settings, weight);
  const SolvedSites b = solved_sites(moved, block.boundary, block.sites, settings, weight);
  CHECK(((b.rest - a.rest).colwise() - step).cwiseAbs().maxCoeff() <=
        tolerance(1e-8, "a rigid motion of 4 mm, solved to 1e-8 of the forces"));
  CHECK((a.displacement - b.displacement).cwiseAbs().maxCoeff() <=
        tolerance(1e-4, "two searches, each to 1e-5 of the press") * 0.004);
  CHECK((a.stress - b.stress).cwiseAbs().maxCoeff() <=
        tolerance(1e-4, "likewise") * a.stress.cwiseAbs().maxCoeff());
}

TEST_CASE("what a press adds to the weight is what the snapshots hold",
          "[campaign][sites][preload]") {
  const Block block;
  const Eigen::Matrix3Xd weight = gravity_load(block.mesh, 4000, {0, 0, -9.81});
  const SolvedSites campaign = solved_sites(block.solver, block.boundary, block.sites,
                                            {.press = 0.003, .levels = 2}, weight);
  CHECK(campaign.rest.row(2).minCoeff() < -1e-4);
  const StressField at_rest = nodal_cauchy_stress(block.solver.model(), campaign.rest);
  for (Eigen::Index s = 0; s < 3; ++s) {
    const Site& site = campaign.sites[std::size_t(s)];
    CHECK(std::abs(campaign.press_depth(2, s) - 0.003) <=
          tolerance(1e-3, "the search of the load") * 0.003);
    for (Eigen::Index l = 0; l < 2; ++l) {
      const Eigen::VectorXd added = campaign.displacement.col(2 * s + l);
      const Eigen::Matrix3Xd u = campaign.rest + Eigen::Map<const Eigen::Matrix3Xd>(
                                                     added.data(), 3, block.mesh.node_count());
      const Eigen::Matrix3Xd press = 0.5 * static_cast<double>(l + 1) * site.full_load *
                                     unit_load(site, block.boundary, block.mesh.node_count());
      Eigen::Matrix3Xd off = block.solver.internal_force(u) - weight - press;
      for (const int n : block.solver.model().fixed_nodes) off.col(n).setZero();
      CHECK(off.cwiseAbs().maxCoeff() <=
            tolerance(1e-5, "a displacement in single precision") * site.full_load);
      const StressField stress = nodal_cauchy_stress(block.solver.model(), u) - at_rest;
      CHECK((campaign.stress.col(2 * s + l) - stress.reshaped()).cwiseAbs().maxCoeff() <=
            tolerance(1e-5, "a displacement in single precision") * stress.cwiseAbs().maxCoeff());
    }
  }
}

}  // namespace
}  // namespace palpable
