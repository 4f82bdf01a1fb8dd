#include "palpable/bake/campaign/calculix_sites.h"

#include "palpable/bake/calculix/calculix.h"
#include "palpable/bake/mesh/inp_file.h"
#include "palpable/common/base/error.h"
#include "tests/support/rubber_block.h"
#include "tests/support/solved_sites.h"
#include "tests/support/test.h"

#include <array>
#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using test::tolerance;

struct Block : test::RubberBlock {
  Block() : RubberBlock(2) {}
  [[nodiscard]] EquilibriumSolver solver(const char* law) const {
    return EquilibriumSolver(model(law));
  }
};

std::vector<SiteSnapshots> by_calculix(const SiteSolver& presses, const std::vector<Site>& sites,
                                       const SiteRunSettings& run, double* done = nullptr) {
  std::vector<SiteSnapshots> all(sites.size());
  std::size_t next = 0;
  CalculixSites(presses, "ccx")
      .solve(sites, run, 1,
             {[&]() -> std::optional<int> {
                return next < sites.size() ? std::optional(static_cast<int>(next++)) : std::nullopt;
              },
              [&](int, double part) {
                if (done != nullptr) *done = part;
              },
              [&](int s, SiteSnapshots site, const StageTimes&) { all[s] = std::move(site); }});
  return all;
}

TEST_CASE("CalculiX and the own solver give the same snapshots", "[campaign][calculix]") {
  if (!find_calculix()) PALPABLE_SKIP("ccx is not installed");
  const Block block;
  const EquilibriumSolver solver = block.solver("neo-hooke-abaqus");
  const SiteSolver presses(solver, block.boundary, Eigen::Matrix3Xd(3, 0));
  const SiteRunSettings run{.press = 0.004, .levels = 3};
  double done = 0;
  const std::vector<SiteSnapshots> theirs = by_calculix(presses, block.sites, run, &done);
  const test::SolvedSites ours = test::solved_sites(solver, block.boundary, block.sites, run);
  CHECK(done > 0.9);
  REQUIRE(theirs.size() == 2);
  for (std::size_t s = 0; s < 2; ++s) {
    INFO("site " << s);
    const auto at = static_cast<Eigen::Index>(3 * s);
    const Eigen::MatrixXd u = ours.displacement.middleCols(at, 3);
    const Eigen::MatrixXd sigma = ours.stress.middleCols(at, 3);
    CHECK((theirs[s].displacement.cast<double>() - u).norm() <=
          tolerance(1e-5, "seven digits of each displacement") * u.norm());
    CHECK((theirs[s].stress.cast<double>() - sigma).norm() <=
          tolerance(1e-4, "stress is computed from differences of them") * sigma.norm());
    CHECK((theirs[s].press_depth - ours.press_depth.col(static_cast<Eigen::Index>(s))).norm() <=
          tolerance(1e-5, "likewise") * theirs[s].press_depth.norm());
    CHECK(theirs[s].outcome.reached_press);
  }
}

TEST_CASE("what CalculiX cannot do is refused in its words or ours", "[campaign][calculix]") {
  const Block block;
  const EquilibriumSolver solver = block.solver("neo-hookean");
  const SiteSolver presses(solver, block.boundary, Eigen::Matrix3Xd(3, 0));
  CHECK_THROWS_WITH(CalculixSites(presses, "no-such-ccx"), Contains("is not installed"));
  const SiteSolver loaded(solver, block.boundary,
                          Eigen::Matrix3Xd::Constant(3, block.mesh.node_count(), 1e-6));
  if (!find_calculix()) PALPABLE_SKIP("ccx is not installed");
  CHECK_THROWS_WITH(CalculixSites(loaded, "ccx"), Contains("nothing else acts"));
  CHECK_THROWS_WITH(by_calculix(presses, block.sites, {.press = 0.001, .levels = 2}),
                    Contains("site 0: ") && Contains("neo-hookean"));
}

TEST_CASE("the decks that we write for CalculiX are read as the meshes that they are",
          "[campaign][calculix][inp][quadratic]") {
  const TetMesh four = box_tets({0, 0, 0}, {0.3, 0.1, 0.2}, 2, 1, 1);
  for (const TetMesh& mesh : {four, with_edge_nodes(four)}) {
    SolidModel model;
    model.mesh = mesh;
    model.material = material_from_young("neo-hooke-abaqus", 1e6, 0.3);
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (mesh.nodes(0, n) == 0.0) model.fixed_nodes.push_back(n);
    }
    const Eigen::Matrix3Xd load = Eigen::Matrix3Xd::Ones(3, mesh.node_count());
    const std::string deck = calculix_deck(model, load, std::array{0.5, 1.0});
    const double unit = calculix_units(model).length;
    const TetMesh again = value_or_throw(parse_inp(deck, "a.inp")).mesh;
    REQUIRE(again.tet_count() == mesh.tet_count());
    REQUIRE(again.is_quadratic() == mesh.is_quadratic());
    const auto same = [&](int a, int b) {
      return (unit * again.nodes.col(a) - mesh.nodes.col(b)).norm() <=
             tolerance(1e-12, "13 digits in the deck");
    };
    for (int e = 0; e < mesh.tet_count(); ++e) {
      for (int k = 0; k < 4; ++k) CHECK(same(again.tets(k, e), mesh.tets(k, e)));
      for (int k = 0; mesh.is_quadratic() && k < 6; ++k) {
        CHECK(same(again.edge_nodes(k, e), mesh.edge_nodes(k, e)));
      }
    }
  }
}

}  // namespace
}  // namespace palpable
