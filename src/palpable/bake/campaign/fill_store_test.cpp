#include "palpable/bake/campaign/fill_store.h"

#include "palpable/bake/describe/body_problem.h"
#include "palpable/common/base/error.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
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
  // In a campaign with twice the levels, every other level is the same state.
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

TEST_CASE("a store holds the mesh and the laws' constants as numbers", "[campaign][store]") {
  const test::ScratchFolder scratch("stored-materials");
  const BodyDescription body = egg_body(scratch.path(), 2);
  const BodyProblem problem = pose_body(body);
  StoreContent written = content_of(body, problem);
  REQUIRE(written.materials.size() == 1);
  // A stiff half, in a law with other constants.
  written.materials.push_back(material_from_constants("mooney-rivlin", std::vector{1e3, 2e3, 3e3}));
  for (std::size_t e = 0; e < written.material_of_element.size(); e += 2) {
    written.material_of_element[e] = 1;
  }
  written.levels = Eigen::Vector2d(0, 1);
  written.keys.assign(written.sites.size(), 7);
  SnapshotStore::create(scratch.path() / "store", written);
  const StoreContent read = SnapshotStore::open(scratch.path() / "store").content();
  CHECK(read.mesh.nodes == problem.model.mesh.nodes);
  CHECK(read.mesh.tets == problem.model.mesh.tets);
  REQUIRE(read.materials.size() == 2);
  CHECK(law_name(read.materials[0]) == law_name(problem.model.material));
  CHECK(constants_of(read.materials[0]) == constants_of(problem.model.material));
  CHECK(law_name(read.materials[1]) == "mooney-rivlin");
  CHECK(constants_of(read.materials[1]) == std::vector{1e3, 2e3, 3e3});
  CHECK(read.material_of_element == written.material_of_element);
  // The same stretch gives the same stress in the stored law and in the one that was solved with.
  const Eigen::Matrix3d F = Eigen::Vector3d(1.2, 0.9, 1.0).asDiagonal();
  CHECK(first_piola(read.materials[0], F) == first_piola(problem.model.material, F));

  SECTION("an element of a material that is not there is refused") {
    written.material_of_element[0] = 2;
    SnapshotStore::create(scratch.path() / "bad", written);
    CHECK_THROWS_WITH(SnapshotStore::open(scratch.path() / "bad"),
                      Contains("campaign.h5") && Contains("a material that does not exist"));
  }
}

}  // namespace
}  // namespace palpable
