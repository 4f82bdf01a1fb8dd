#include "palpable/intrusive/beam_study.h"

#include "palpable/base/error.h"
#include "palpable/reduced/body_file.h"
#include "palpable/reduced/loaded_body.h"
#include "tests/support/beam_description.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using test::tolerance;

const IntrusiveBake& made() {
  static const IntrusiveBake one = [] {
    const test::ScratchFolder folder("study");
    return bake_intrusive(
        test::describe_small_beam(folder.path(),
                                  "[intrusive]\npositions = \"TOP\"\nreactions = \"UNDER\"\n"
                                  "force = \"2 N\"\nmodes = 24\nstress_modes = 60\n"),
        {.version = "test", .command_line = "none"});
  }();
  return one;
}

TEST_CASE("fresh Newton solves and two loads are met within what is stated", "[bake][intrusive]") {
  const std::vector<NewtonCheck> checks = newton_checks(made(), 5, 1);
  REQUIRE(checks.size() == 5);
  CHECK(checks[0].site != checks[1].site);
  for (const NewtonCheck& check : checks) {
    INFO("site " << check.site << " level " << check.level);
    CHECK(check.displacement <= 2.0 * made().report.displacement.worst);
    CHECK(check.stress <= 2.0 * made().report.stress_worst);
    CHECK(check.deflection > 0.0);
  }
  // The same seed, the same presses.
  CHECK(newton_checks(made(), 2, 1)[1].level == checks[1].level);
  CHECK(newton_checks(made(), 1, 2)[0].level != checks[0].level);

  REQUIRE(made().body.several);
  CHECK(made().body.several->mode_count() == 34);
  CHECK(made().body.several->checked == 6);
  CHECK(made().body.several->error_worst <= 0.03);
  CHECK(made().body.several->error_median < made().body.several->error_worst);
  CHECK(made().report.cpu.ms("references") > 0.0);
  for (const TwoLoadCheck& check : two_load_checks(made(), 5, 2)) {
    CHECK(check.error <= 0.03);
    CHECK(check.deflection > 0.0);
  }
}

TEST_CASE("the body that was read solves two loads as the bake's own energy does",
          "[bake][intrusive][several]") {
  const test::ScratchFolder folder("study_body");
  write_body_file(folder.path() / "beam.palpable", made().body);
  const ReducedBody body = value_or_throw(read_pressable_body(folder.path() / "beam.palpable"));
  LoadedBody loaded = value_or_throw(LoadedBody::make(body));
  const auto S = static_cast<int>(body.sites.size());
  REQUIRE(body.several->reactions.size() >= 3);
  const std::array<PlacedLoad, 3> loads{PlacedLoad{S - 1, 0.7}, PlacedLoad{S / 3, 0.25},
                                        PlacedLoad{S + 2, 0.5}};
  REQUIRE(loaded.solve(loads).ok());

  // With the forces on all nodes and the modes of all nodes, in double precision.
  const TravellingLoad& travelling = made().travelling;
  const VectorXd f = 0.7 * VectorXd(travelling.load.col(S - 1)) +
                     0.25 * VectorXd(travelling.load.col(S / 3)) +
                     0.5 * VectorXd(travelling.reaction.col(2));
  QuarticEquilibrium own(made().body.several->energy);
  VectorXd q = VectorXd::Zero(34);
  REQUIRE(own.solve(made().energy_modes.transpose() * f, q).converged);
  CHECK((loaded.amplitudes() - q).norm() <=
        tolerance(1e-5, "forces end at 1e-6 of the load, modes of the file have 24 bits") *
            q.norm());
  const VectorXd u = made().energy_modes * q;
  std::vector<float> got(3 * made().travelling.problem.mesh.boundary.node_of_vertex.size());
  loaded.displacement(got);
  double gone = 0.0, whole = 0.0;
  for (std::size_t v = 0; v < got.size() / 3; ++v) {
    const int n = travelling.problem.mesh.boundary.node_of_vertex[v];
    for (std::size_t i = 0; i < 3; ++i) {
      const double truth = u[3 * n + static_cast<Index>(i)];
      gone += std::pow(static_cast<double>(got[3 * v + i]) - truth, 2);
      whole += truth * truth;
    }
  }
  CHECK(std::sqrt(gone / whole) <= tolerance(1e-5, "likewise"));
}

TEST_CASE("left out, every second position is met; a linear body is not", "[bake][intrusive]") {
  const IntrusiveBake& m = made();
  const HeldOutPositions held_out = held_out_positions(m.series, m.travelling, m.table, 40);
  CHECK(held_out.held_out + held_out.trained_on == m.table.positions());
  // 12 positions in a row of 2.5 cm: coarser than the beam itself, whose rows have 52.
  CHECK(held_out.held_out >= m.table.positions() / 3);
  CHECK(held_out.global <= tolerance(5e-3, "positions 2.5 cm apart and patches of that size"));
  CHECK(held_out.worst <= tolerance(0.03, "likewise"));
  CHECK(held_out.worst > held_out.global);
  // About 0.55 of deflection over length (0.15), by prototypes: it lacks the shortening.
  CHECK(linear_model_error(m.table) > 0.05);
  CHECK(linear_model_error(m.table) < 0.2);
}

TEST_CASE("a body differs from itself in nothing, from a poorer one by what that lacks",
          "[bake][intrusive]") {
  const ReducedBody& body = made().body;
  const BodyDifference none = body_difference(body, body);
  CHECK(none.shared == static_cast<int>(body.sites.size()));
  CHECK(none.displacement_worst == 0.0);
  ReducedBody poorer = body;
  poorer.displacement = body.displacement.truncated(6);
  for (Site& site : poorer.sites) site.full_load *= 0.5;
  poorer.sites.pop_back();
  const BodyDifference some = body_difference(poorer, body);
  CHECK(some.shared == none.shared - 1);
  // Its full load is half of the other's: at equal forces its levels are twice those.
  CHECK(some.displacement_pooled > 0.8);
  CHECK(some.displacement_median <= some.displacement_worst);
  CHECK(some.stress_worst > 0.0);
  poorer.sites.clear();
  CHECK_THROWS_AS(body_difference(poorer, body), Error);
  poorer.surface.vertices(0, 0) += 0.01;
  CHECK_THROWS_AS(body_difference(poorer, body), Error);
}

}  // namespace
}  // namespace palpable
