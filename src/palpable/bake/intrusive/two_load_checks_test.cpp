#include "palpable/bake/intrusive/two_load_checks.h"

#include "palpable/common/body_file/body_file.h"
#include "palpable/common/reduced/loaded_body.h"
#include "tests/support/baked_beam.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using test::tolerance;

const IntrusiveBake& made() { return test::baked_beam(); }

TEST_CASE("two loads at once are met within what the body states", "[intrusive][several]") {
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
          "[intrusive][several]") {
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

}  // namespace
}  // namespace palpable
