#include "palpable/bake/touch_bake/touch_store.h"

#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

TouchTables some_tables() { return test::some_touch_tables(sphere_surface({0, 0, 0}, 0.05, 1), 2); }

SolidModel block() {
  return test::standing_rubber(box_tets({0, 0, 0}, {0.03, 0.03, 0.03}, 2, 2, 2));
}

TouchKeys keys_of(const SolidModel& model, const TouchBakeSettings& settings = {}) {
  return touch_keys(SkinResponse(model, boundary_of(model.mesh)), settings);
}

TEST_CASE("a stored table is found again only under its own key", "[touch_bake][files]") {
  const ScratchFolder folder("touch_store");
  const TouchTables tables = some_tables();
  const TouchKeys keys{1, 2, 3, 4};
  const TouchStore store(folder / "touch");
  CHECK_FALSE(store.find_compliance(keys));
  store.keep(keys, tables.compliance);
  store.keep(keys, tables.regions[1]);
  store.keep(keys, tables.cross);
  store.keep(keys, tables.shell);

  CHECK(store.find_compliance(keys).value().near == tables.compliance.near);
  const int vertex = tables.regions[1].vertex;
  CHECK(store.find_region(keys, vertex).value().quartic.values == tables.regions[1].quartic.values);
  CHECK(store.find_cross(keys).value().cubic.scale == tables.cross.cubic.scale);

  CHECK(store.find_shell(keys).value().weights == tables.shell.weights);

  CHECK_FALSE(store.find_compliance({7, 2, 3, 4}));
  CHECK_FALSE(store.find_region({1, 7, 3, 4}, vertex));
  CHECK_FALSE(store.find_cross({1, 2, 7, 4}));
  CHECK_FALSE(store.find_shell({1, 2, 3, 7}));
  CHECK_FALSE(store.find_region(keys, tables.regions[0].vertex));
  // The file of another region under this region's name is not accepted.
  fs::copy_file(store.folder() / "region_000008.h5", store.folder() / "region_000001.h5");
  CHECK(tables.regions[0].vertex == 1);
  CHECK_FALSE(store.find_region(keys, 1));
}

TEST_CASE("a table that is damaged is made again", "[touch_bake][files]") {
  const ScratchFolder folder("touch_store");
  const TouchStore store(folder / "touch");
  const TouchKeys keys{1, 2, 3, 4};
  store.keep(keys, some_tables().cross);
  const fs::path file = store.folder() / "cross.h5";
  const std::string good = test::file_bytes(file);
  for (const std::size_t at : {std::size_t{5}, std::size_t{600}, good.size() - 1}) {
    std::string damaged = good;
    damaged[at] ^= 1;
    test::write_bytes(file, damaged);
    CHECK_FALSE(store.find_cross(keys));
  }
  test::write_bytes(file, good.substr(0, good.size() / 2));
  CHECK_FALSE(store.find_cross(keys));
  test::write_bytes(file, good);
  CHECK(store.find_cross(keys));
}

TEST_CASE("a list says which tables belong to a campaign", "[touch_bake][files]") {
  const ScratchFolder folder("touch_store");
  const TouchStore store(folder / "touch");
  TouchTables tables = some_tables();
  const TouchKeys keys{1, 2, 3, 4};
  CHECK_FALSE(store.find_listed(11));
  store.keep(keys, tables.compliance);
  store.keep(keys, tables.cross);
  store.keep(keys, tables.shell);
  for (const RegionTable& region : tables.regions) store.keep(keys, region);
  store.keep_list(11, keys, tables);
  const TouchTables found = store.find_listed(11).value();
  CHECK(found.compliance.couplings.values == tables.compliance.couplings.values);
  REQUIRE(found.regions.size() == 2);
  CHECK(found.regions[1].vertex == tables.regions[1].vertex);
  CHECK(found.cross.cubic.values == tables.cross.cubic.values);
  CHECK(found.shell.points == tables.shell.points);
  CHECK(found.region_reach == tables.region_reach);
  CHECK(found.point_spacing == tables.point_spacing);
  CHECK_FALSE(store.find_listed(12));

  // A list without regions and cross terms gives none, even if their files are there.
  tables.regions.clear();
  tables.cross = {};
  store.keep_list(11, keys, tables);
  CHECK(store.find_listed(11).value().regions.empty());
  CHECK(store.find_listed(11).value().cross.cubic.variables == 0);

  store.keep_list(11, keys, some_tables());
  fs::remove(store.folder() / "region_000008.h5");
  CHECK_FALSE(store.find_listed(11));
  store.keep(keys, some_tables().regions[1]);
  CHECK(store.find_listed(11));
  fs::remove(store.folder() / "shell.h5");
  CHECK_FALSE(store.find_listed(11));
}

TEST_CASE("vibration modes are stored, and a list that names them needs them",
          "[touch_bake][files]") {
  const ScratchFolder folder("touch_store");
  const TouchStore store(folder / "touch");
  TouchTables tables = some_tables();
  tables.vibration = test::some_vibration(tables.shell.nodes());
  TouchKeys keys{1, 2, 3, 4};
  keys.vibration = 6;
  store.keep(keys, tables.compliance);
  store.keep(keys, tables.cross);
  store.keep(keys, tables.shell);
  for (const RegionTable& region : tables.regions) store.keep(keys, region);
  store.keep_list(11, keys, tables);
  CHECK_FALSE(store.find_listed(11));
  store.keep(keys, *tables.vibration);
  CHECK(store.find_vibration(keys).value().shapes == tables.vibration->shapes);
  CHECK(store.find_listed(11).value().vibration.value().omega == tables.vibration->omega);
  keys.vibration = 7;
  CHECK_FALSE(store.find_vibration(keys));
  // A list of tables without modes gives none, even if the file is there.
  tables.vibration.reset();
  store.keep_list(11, keys, tables);
  CHECK_FALSE(store.find_listed(11).value().vibration.has_value());
}

TEST_CASE("held-out touches solved so far are stored with their numbers", "[touch_bake][files]") {
  const ScratchFolder folder("touch_store");
  const TouchStore store(folder / "touch");
  TouchKeys keys{1, 2, 3, 4};
  keys.held_out = 5;
  SolvedTouches solved(4);
  solved[1] = HeldOutTouch{PressingThing::kPalm, 0.003, 0.01, 0.02, 0.03};
  solved[3] = HeldOutTouch{PressingThing::kRim, 0.004, NAN, NAN, NAN};  // could not be followed
  store.keep(keys, solved);
  const SolvedTouches again = store.find_held_out(keys).value();
  REQUIRE(again.size() == 4);
  CHECK_FALSE((again[0] || again[2]));
  CHECK((again[1]->thing == PressingThing::kPalm && again[1]->von_mises == 0.03));
  CHECK((again[3] && std::isnan(again[3]->force)));
  REQUIRE(followed(again).size() == 1);
  CHECK(followed(again)[0].depth == 0.003);
  keys.held_out = 6;
  CHECK_FALSE(store.find_held_out(keys));

  // The list finds the tables with the touches, and also without them.
  const TouchTables tables = some_tables();
  keys.held_out = 5;
  store.keep(keys, tables.compliance);
  store.keep(keys, tables.shell);
  store.keep(keys, tables.cross);
  for (const RegionTable& region : tables.regions) store.keep(keys, region);
  store.keep_list(11, keys, tables);
  CHECK(store.find_listed(11).value().held_out.size() == 1);
  test::write_bytes(store.folder() / "held_out.h5", "no file of touches");
  CHECK(store.find_listed(11).value().held_out.empty());
}

TEST_CASE("leftovers of killed processes are removed, files being written are not",
          "[touch_bake][files]") {
  const ScratchFolder folder("touch_store");
  const TouchStore store(folder / "touch");
  store.remove_leftovers();  // the folder does not exist yet
  store.keep({1, 2, 3, 4}, some_tables().cross);
  const std::string growing = "cross.h5" + own_part_suffix();
  test::write_bytes(store.folder() / growing, "x");
  test::write_bytes(store.folder() / "cross.h5.part-elsewhere-12", "x");
  store.remove_leftovers();
  CHECK(fs::exists(store.folder() / "cross.h5"));
  CHECK(fs::exists(store.folder() / growing));
  CHECK_FALSE(fs::exists(store.folder() / "cross.h5.part-elsewhere-12"));
}

TEST_CASE("a store that cannot be written is a clear error", "[touch_bake][errors]") {
  const ScratchFolder folder("touch_store");
  test::write_bytes(folder / "touch", "a file");
  CHECK_THROWS_WITH(TouchStore(folder / "touch").keep({}, some_tables().cross),
                    Catch::Contains("touch"));
}

TEST_CASE("a table's key changes with everything that the table is computed from", "[touch_bake]") {
  const SolidModel model = block();
  const TouchKeys keys = keys_of(model);
  CHECK(keys == keys_of(model));
  CHECK(keys.regions != keys.cross);

  const std::vector<std::pair<const char*, std::function<void(SolidModel&)>>> bodies{
      {"a node", [](auto& m) { m.mesh.nodes(0, 13) += 1e-9; }},
      {"a constant", [](auto& m) { m.material = material_from_young("neo-hookean", 61e3, 0.4); }},
      {"the law",
       [](auto& m) {
         const std::vector<double> same = constants_of(m.material);
         m.material = SaintVenantKirchhoff{same[0], same[1]};
       }},
      {"a part",
       [](auto& m) {
         m.groups.push_back({m.material, {3}});
       }},
      {"another part of it",
       [](auto& m) {
         m.groups.push_back({m.material, {4}});
       }},
      {"the support", [](auto& m) { m.fixed_nodes.pop_back(); }},
  };
  std::set<std::uint64_t> all{keys.compliance};
  for (const auto& [what, change] : bodies) {
    INFO(what);
    SolidModel other = model;
    change(other);
    const TouchKeys changed = keys_of(other);
    CHECK(all.insert(changed.compliance).second);
    CHECK(changed.regions != keys.regions);
    CHECK(changed.cross != keys.cross);
    CHECK(changed.shell != keys.shell);
  }
  // Each key depends on the settings of its own table, that of regions also on the compliance's.
  const auto with = [&](auto change) {
    TouchBakeSettings settings;
    change(settings);
    return keys_of(model, settings);
  };
  CHECK(with([](auto& s) { s.threads = 7; }) == keys);
  CHECK(with([](auto& s) { s.regions.most = 3; }) == keys);
  const TouchKeys rank = with([](auto& s) { s.compliance.rank = 16; });
  CHECK((rank.compliance != keys.compliance && rank.regions != keys.regions &&
         rank.cross == keys.cross));
  const TouchKeys reach = with([](auto& s) { s.regions.reach = 0.02; });
  CHECK((reach.compliance == keys.compliance && reach.regions != keys.regions &&
         reach.cross == keys.cross));
  CHECK(keys.vibration == 0);
  const TouchKeys heavy = with([](auto& s) { s.inertia = {.density = 1000}; });
  CHECK((heavy.vibration != 0 && heavy.compliance == keys.compliance));
  for (const InertiaSettings& other :
       {InertiaSettings{.density = 1001}, InertiaSettings{.density = 1000, .loss_factor = 0.1},
        InertiaSettings{.density = 1000, .modes = 21},
        InertiaSettings{.density = 1000, .below = 300}}) {
    CHECK(with([&](auto& s) { s.inertia = other; }).vibration != heavy.vibration);
  }
  const TouchKeys pairs = with([](auto& s) { s.cross.pairs = 10; });
  CHECK((pairs.compliance == keys.compliance && pairs.regions == keys.regions &&
         pairs.cross != keys.cross));
}

}  // namespace
}  // namespace palpable
