#include "palpable/bake/campaign/set_aside.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/body_file/hdf5_tools.h"
#include "tests/support/rubber_block.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// The content of a campaign with a site for each key; its units are written without being solved.
StoreContent campaign_of(const std::vector<std::uint64_t>& keys) {
  const test::RubberBlock block(static_cast<int>(keys.size()));
  StoreContent content;
  content.name = "block";
  content.mesh = block.mesh;
  content.sites = block.sites;
  content.levels = Eigen::VectorXd::LinSpaced(2, 0.0, 1.0);
  content.fixed.assign(block.boundary.surface.vertex_count(), 0);
  content.keys = keys;
  return content;
}

void write_units(const SnapshotStore& store) {
  const int N = store.content().mesh.node_count();
  SiteSnapshots site;
  site.full_load = 1.0;
  site.press_depth = Eigen::VectorXd::LinSpaced(2, 0.0, 1e-3);
  site.displacement = Eigen::MatrixXf::Constant(3 * N, 1, 1e-3f);
  site.stress = Eigen::MatrixXf::Constant(6 * N, 1, 1.0f);
  for (int u = 0; u < store.content().unit_count(); ++u) {
    if (!store.has(u)) store.write(u, site, Eigen::Matrix3Xd::Zero(3, N));
  }
}

int folders_in(const fs::path& folder) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) count += entry.is_directory();
  return count;
}

TEST_CASE("a campaign that is being solved keeps others out of its folder",
          "[campaign][aside][refusal]") {
  const test::ScratchFolder folder("held_store");
  const fs::path store = folder / "block.snapshots";
  const SnapshotStore solving = SnapshotStore::create(store, campaign_of({1, 2, 3}));
  const FolderLock run(store, Holding::kWithOthers);
  const auto edit = [&] { (void)set_aside_other_campaign(store, campaign_of({1, 5, 6})); };
  const auto refused = Catch::Contains("block.snapshots: another run is writing into it");
  CHECK_THROWS_WITH(edit(), refused);  // before its first site is solved, too
  write_units(solving);
  CHECK_THROWS_WITH(edit(), refused);
  CHECK(folders_in(folder.path()) == 1);
  CHECK_FALSE(set_aside_other_campaign(store, campaign_of({1, 2, 3})));  // the same, as shards do
}

TEST_CASE("a run whose folder became another one's before it held it is refused",
          "[campaign][aside][refusal]") {
  const test::ScratchFolder folder("taken_store");
  const fs::path store = folder / "block.snapshots";
  const StoreContent own = campaign_of({1, 2, 3});
  write_units(SnapshotStore::create(store, own));
  CHECK_NOTHROW(require_own_campaign(store, own));
  const StoreContent other = campaign_of({1, 5, 6});
  REQUIRE(set_aside_other_campaign(store, other));
  const SnapshotStore taken = SnapshotStore::create(store, other);
  CHECK_THROWS_WITH(require_own_campaign(store, own),
                    Catch::Contains("block.snapshots: another run began to fill it"));
  CHECK_NOTHROW(require_own_campaign(store, other));
}

TEST_CASE("snapshots of an edited description are set aside and come back", "[campaign][aside]") {
  const test::ScratchFolder folder("set_aside");
  const fs::path store = folder / "block.snapshots";
  CHECK_FALSE(set_aside_other_campaign(store, campaign_of({1, 2, 3})));
  write_units(SnapshotStore::create(store, campaign_of({1, 2, 3})));
  CHECK_FALSE(set_aside_other_campaign(store, campaign_of({1, 2, 3})));
  CHECK_FALSE(set_aside_other_campaign(store, campaign_of({1, 2, 3, 4})));  // nothing is lost

  // Edited: of three sites, one still holds.
  const auto moved = set_aside_other_campaign(store, campaign_of({1, 5, 6}));
  REQUIRE(moved);
  CHECK(moved->units == 3);
  CHECK(moved->still_valid == 1);
  CHECK_FALSE(moved->brought_back);
  CHECK(moved->folder.string().starts_with(store.string() + "."));
  const SnapshotStore aside = SnapshotStore::open(moved->folder);
  for (const int u : {0, 1, 2}) CHECK(aside.has(u));
  const SnapshotStore edited = SnapshotStore::create(store, campaign_of({1, 5, 6}));
  CHECK(edited.has(0));
  CHECK(edited.why_not(1) == "missing");
  write_units(edited);
  edited.finish();
  for (const int u : {0, 1, 2}) CHECK(aside.has(u));  // a link is not written through

  // Edited back: the first campaign's own come back, whole, and the second's are kept.
  const auto back = set_aside_other_campaign(store, campaign_of({1, 2, 3}));
  REQUIRE(back);
  CHECK(back->brought_back);
  const SnapshotStore first = SnapshotStore::create(store, campaign_of({1, 2, 3}));
  for (const int u : {0, 1, 2}) CHECK(first.has(u));
  const SnapshotStore second = SnapshotStore::open(back->folder);
  for (const int u : {0, 1, 2}) CHECK(second.has(u));
  CHECK(folders_in(folder.path()) == 2);
}

TEST_CASE("linear responses that hold for both descriptions stand in both folders",
          "[campaign][aside]") {
  const test::ScratchFolder folder("linear_aside");
  const fs::path store = folder / "block.snapshots";
  const auto with_linear = [](const std::vector<std::uint64_t>& keys, std::uint64_t linear_key) {
    StoreContent content = campaign_of(keys);
    content.linear = {0, 1};
    content.linear_key = linear_key;
    return content;
  };
  const SnapshotStore first = SnapshotStore::create(store, with_linear({1}, 10));
  write_units(first);
  const int vertices = static_cast<int>(first.content().fixed.size());
  first.write_linear(0, Eigen::MatrixXf::Constant(3 * vertices, 2, 1e-6f));

  REQUIRE(set_aside_other_campaign(store, with_linear({2}, 10)));
  const SnapshotStore pressed = SnapshotStore::create(store, with_linear({2}, 10));
  CHECK(pressed.why_not(0) == "missing");
  CHECK(pressed.has_linear(0));

  // The units are the same, but the linear responses are of other vertices.
  write_units(pressed);
  const auto moved = set_aside_other_campaign(store, with_linear({2}, 11));
  REQUIRE(moved);
  CHECK(moved->still_valid == 1);
  const SnapshotStore other = SnapshotStore::create(store, with_linear({2}, 11));
  CHECK(other.has(0));
  CHECK_FALSE(other.has_linear(0));
  CHECK(SnapshotStore::open(moved->folder).has_linear(0));
}

TEST_CASE("tables of touch stand in both folders, and one that is made again in one alone",
          "[campaign][aside]") {
  const test::ScratchFolder folder("touch_aside");
  const fs::path store = folder / "block.snapshots";
  const SnapshotStore first = SnapshotStore::create(store, campaign_of({1, 2}));
  write_units(first);
  fs::create_directories(first.touch_folder());
  test::write_bytes(first.touch_folder() / "cross.h5", "first");
  test::write_bytes(first.touch_folder() / "cross.h5.part-host-1", "half");

  const auto moved = set_aside_other_campaign(store, campaign_of({1, 5}));
  REQUIRE(moved);
  const fs::path aside = moved->folder / "touch", now = store / "touch";
  CHECK(test::file_bytes(now / "cross.h5") == "first");
  CHECK_FALSE(fs::exists(now / "cross.h5.part-host-1"));
  hdf5::write_durably(now / "cross.h5", "second");
  CHECK(test::file_bytes(aside / "cross.h5") == "first");

  write_units(SnapshotStore::create(store, campaign_of({1, 5})));
  REQUIRE(set_aside_other_campaign(store, campaign_of({1, 2})));
  CHECK(test::file_bytes(now / "cross.h5") == "first");
}

TEST_CASE("a campaign without a unit leaves nothing to set aside", "[campaign][aside]") {
  const test::ScratchFolder folder("nothing_aside");
  const fs::path store = folder / "block.snapshots";
  (void)SnapshotStore::create(store, campaign_of({1, 2, 3}));
  CHECK_FALSE(set_aside_other_campaign(store, campaign_of({4, 5, 6})));
  CHECK(folders_in(folder.path()) == 1);
}

TEST_CASE("a body file does not lie among its snapshots", "[campaign]") {
  const test::ScratchFolder folder("among_snapshots");
  const std::filesystem::path store = folder.path() / "a.snapshots";
  std::filesystem::create_directories(store);
  CHECK_NOTHROW(refuse_among_snapshots(folder.path() / "a.palpable", store));
  CHECK_NOTHROW(refuse_campaign_folder(folder.path()));
  fs::create_directories(store);
  std::ofstream(store / "campaign.h5") << "a campaign";
  CHECK_THROWS_WITH(refuse_campaign_folder(store), Catch::Contains("snapshots of a campaign"));
  CHECK_THROWS_WITH(refuse_among_snapshots(store / "campaign.h5", store),
                    Catch::Contains("lies in the folder of the snapshots"));
  CHECK_THROWS_WITH(refuse_among_snapshots(store, store), Catch::Contains("a.palpable"));
}

}  // namespace
}  // namespace palpable
