#include "palpable/bake/campaign/solid_file.h"

#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/common/base/error.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using test::egg_body;
using test::solved_store;

StoreContent egg(const std::filesystem::path& folder) {
  const BodyDescription body = egg_body(folder, 2);
  return content_of(body, pose_body(body));
}

TEST_CASE("what was solved without a campaign is read back to the last bit", "[campaign][solid]") {
  const test::ScratchFolder scratch("solid-file");
  StoreContent written = egg(scratch.path());
  written.materials.push_back(material_from_constants("mooney-rivlin", std::vector{1e3, 2e3, 3e3}));
  for (std::size_t e = 0; e < written.material_of_element.size(); e += 2) {
    written.material_of_element[e] = 1;
  }
  const std::filesystem::path body = scratch.path() / "egg.palpable";
  CHECK(solid_file_of(body) == scratch.path() / "egg.solid.h5");
  CHECK_FALSE(solid_beside(body, kWithoutCampaign).has_value());
  write_solid_file(solid_file_of(body), written);
  const std::optional<StoreContent> read = solid_beside(body, kWithoutCampaign);
  REQUIRE(read.has_value());
  CHECK(solids_differ(*read, written).empty());
  CHECK(read->materials.size() == 2);
  CHECK(read->material_of_element == written.material_of_element);
  CHECK(read->fixed == written.fixed);
  // It is not read as a campaign, and a damaged file is refused.
  CHECK_FALSE(solid_beside(body, "per-site").has_value());
  test::write_bytes(solid_file_of(body), "palpable");
  CHECK_THROWS_WITH(solid_beside(body, kWithoutCampaign), Contains("egg.solid.h5"));
  CHECK_THROWS_WITH(write_solid_file(scratch.path() / "none" / "egg.solid.h5", written),
                    Contains("egg.solid.h5"));
}

TEST_CASE("a campaign keeps the solid beside its body", "[campaign][solid]") {
  const test::ScratchFolder scratch("solid-campaign");
  const BodyDescription body = egg_body(scratch.path(), 2);
  const SnapshotStore store = solved_store(body, scratch.path() / "egg.snapshots");
  const std::optional<StoreContent> kept =
      solid_beside(scratch.path() / "egg.palpable", "per-site");
  REQUIRE(kept.has_value());
  CHECK(solids_differ(*kept, egg(scratch.path())).empty());
}

TEST_CASE("two solids differ in mesh, support, groups or constants", "[campaign][solid]") {
  const test::ScratchFolder scratch("solids-differ");
  const StoreContent solid = egg(scratch.path());
  StoreContent other = solid;
  other.mesh.nodes(1, 3) = std::nextafter(other.mesh.nodes(1, 3), 1.0);
  CHECK_THAT(solids_differ(other, solid), StartsWith("another mesh: as many"));
  other = solid;
  std::swap(other.mesh.tets(0, 0), other.mesh.tets(1, 0));
  CHECK_THAT(solids_differ(other, solid), StartsWith("another mesh: as many"));
  other = solid;
  other.mesh.tets.conservativeResize(4, other.mesh.tets.cols() - 1);
  CHECK_THAT(solids_differ(other, solid), StartsWith("another mesh:") && Contains("instead of"));
  other = solid;
  other.fixed.front() ^= 1;
  CHECK_THAT(solids_differ(other, solid), StartsWith("another support"));
  other = solid;
  other.material_of_element.back() = 1;
  CHECK_THAT(solids_differ(other, solid), StartsWith("another material: other groups"));
  other = solid;
  other.materials = {material_from_young("neo-hookean", 1e3, 0.3)};
  CHECK_THAT(solids_differ(other, solid), StartsWith("another material: neo-hookean"));
  // Another law with the same constants.
  other.materials = {
      material_from_constants("saint-venant-kirchhoff", constants_of(solid.materials.front()))};
  CHECK_THAT(solids_differ(other, solid), Contains("saint-venant-kirchhoff with"));
  other.materials.clear();  // an older store has none
  CHECK(solids_differ(other, solid).empty());
}

}  // namespace
}  // namespace palpable
