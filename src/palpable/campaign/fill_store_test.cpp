#include "palpable/campaign/fill_store.h"

#include "palpable/base/error.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using test::egg_body;
using test::solved_store;
using test::tolerance;

TEST_CASE("levels between are solved under the loads of the campaign", "[campaign][heldout]") {
  const test::ScratchFolder scratch("held-out");
  const BodyDescription body = egg_body(scratch.path(), 2);
  const SnapshotStore campaign = solved_store(body, scratch.path() / "campaign");
  const SnapshotStore between = solved_store(body, scratch.path() / "between", &campaign);
  REQUIRE(between.content().level_count() == 2);
  CHECK(between.content().levels[1] == 0.25);
  CHECK(between.content().levels[2] == 0.75);
  // Of a campaign with twice the levels, every other level is the same state.
  const SnapshotStore fine = solved_store(egg_body(scratch.path(), 4), scratch.path() / "fine");
  const StoredField& moved = between.content().fields[0];
  const Eigen::Index rows = 3 * between.content().mesh.node_count();
  for (int s = 0; s < 2; ++s) {
    CHECK(std::abs(between.unit(s).full_load - campaign.unit(s).full_load) == 0.0);
    const Eigen::MatrixXf a = between.rows(s, moved, 0, rows), b = fine.rows(s, moved, 0, rows);
    for (const int l : {0, 1}) {
      CHECK((a.col(l) - b.col(2 * l)).norm() <=
            tolerance(1e-4f, "the load of a press is found to three digits and then kept") *
                b.col(2 * l).norm());
      CHECK(std::abs(between.unit(s).press_depth[l + 1] / fine.unit(s).press_depth[2 * l + 1] -
                     1) <= tolerance(1e-4, "likewise"));
    }
  }
  CHECK_THROWS_AS(solved_store(egg_body(scratch.path(), 3), scratch.path() / "other", &campaign),
                  Error);
}

}  // namespace
}  // namespace palpable
