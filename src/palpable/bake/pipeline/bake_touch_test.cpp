#include "palpable/bake/pipeline/bake_touch.h"

#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/describe/touch_mesh.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_text.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;
using Tables = BodyDescription::Touch::Tables;

FilledStore fill(const BodyDescription& egg, const fs::path& folder) {
  LocalCrew crew;
  FillSettings settings;
  settings.threads = 2;
  settings.store = folder;
  return fill_store(egg, settings, crew);
}

std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    files[entry.path().filename().string()] = test::file_bytes(entry.path());
  }
  return files;
}

struct Stop : std::runtime_error {
  Stop() : std::runtime_error("stopped") {}
};

TEST_CASE("a bake of tables that is stopped again and again ends with the bytes of one that is not",
          "[pipeline][touch][long]") {
  const ScratchFolder folder("bake_touch");
  BodyDescription egg = test::egg_body(folder.path(), 2);
  egg.touch = {.tables = Tables::kFull, .regions = 3, .held_out = 2};
  ReducedBody body = [&] {
    const FilledStore filled = fill(egg, folder / "whole.snapshots");
    return reduce_store(filled.store, {}).body;
  }();
  const auto write = [&](const char* name) {
    return [&, name](const TouchTables& tables, BodyStage) {
      body.provenance.touch = touch_line(tables);
      write_touchable_body(folder / name, body, tables);
    };
  };
  const FilledStore whole = fill(egg, folder / "whole.snapshots");
  bake_touch(egg, whole.plan, whole.store, 2, write("whole.palpable"));

  // Stopped after ever more reports of progress, so that each run finishes a little.
  const FilledStore stopped = fill(egg, folder / "stopped.snapshots");
  fs::create_directories(stopped.store.touch_folder());
  test::write_bytes(stopped.store.touch_folder() / "cross.h5.part-elsewhere-7", "of a killed run");
  int stops = 0;
  for (bool ended = false; !ended; ++stops) {
    REQUIRE(stops < 50);
    int left = 3 + 12 * stops;
    const auto stop = [&](const ProgressReport& report) {
      if (--left == 0 && report.done < report.total) throw Stop();
    };
    try {
      bake_touch(egg, stopped.plan, stopped.store, 1, write("stopped.palpable"), stop);
      ended = true;
    } catch (const Stop&) {}
  }
  CHECK(stops > 3);
  CHECK(files_of(whole.store.touch_folder()) == files_of(stopped.store.touch_folder()));
  CHECK(test::file_bytes(folder / "whole.palpable") ==
        test::file_bytes(folder / "stopped.palpable"));

  const TouchableBody read = value_or_throw(read_touchable_body(folder / "whole.palpable"));
  REQUIRE(read.touch);
  CHECK(read.touch->regions.size() == 3);
  CHECK(read.touch->cross.cubic.variables > 0);
  REQUIRE(read.touch->held_out.size() == 2);
  CHECK(read.touch->held_out[0].thing == PressingThing::kFinger);
  CHECK(read.touch->held_out[1].thing == PressingThing::kPalm);
  for (const HeldOutTouch& touch : read.touch->held_out) {
    CHECK((touch.displacement > 0 && touch.displacement < 0.5));
  }
  CHECK(read.body.provenance.touch == touch_line(*read.touch));

  // Everything is there: nothing is made, and `reduce` finds it.
  bool made = false;
  bake_touch(
      egg, whole.plan, whole.store, 1, [](const TouchTables&, BodyStage) {},
      [&](const ProgressReport&) { made = true; });
  CHECK_FALSE(made);
  REQUIRE(kept_touch_tables(whole.store));
  CHECK(kept_touch_tables(whole.store)->regions[2].cubic.values ==
        read.touch->regions[2].cubic.values);
  CHECK(kept_touch_tables(whole.store)->held_out[1].force == read.touch->held_out[1].force);
}

TEST_CASE("linear tables can be used before the others are there", "[pipeline][touch][long]") {
  const ScratchFolder folder("bake_touch");
  BodyDescription egg = test::egg_body(folder.path(), 2);
  const FilledStore filled = fill(egg, folder / "egg.snapshots");
  std::vector<std::size_t> regions;
  std::vector<BodyStage> stages;
  const auto use = [&](const TouchTables& tables, BodyStage stage) {
    regions.push_back(tables.regions.size());
    stages.push_back(stage);
  };
  const auto bake = [&](const CampaignPlan& plan, const BodyDescription::Touch& wanted) {
    egg.touch = wanted;
    CHECK(bake_touch(egg, plan, filled.store, 2, use).empty());
  };
  CampaignPlan with_parameter = filled.plan;
  with_parameter.points.push_back(with_parameter.points[0]);
  bake(with_parameter, {.tables = Tables::kNone});
  CHECK(regions.empty());
  CHECK_FALSE(fs::exists(filled.store.touch_folder()));
  CHECK_FALSE(kept_touch_tables(filled.store));
  bake(filled.plan, {.tables = Tables::kLinear, .held_out = 0});
  CHECK(regions == std::vector<std::size_t>{0});
  CHECK(kept_touch_tables(filled.store)->regions.empty());
  CHECK(kept_touch_tables(filled.store)->cross.cubic.variables == 0);
  bake(filled.plan, {.tables = Tables::kFull, .regions = 1, .held_out = 1});
  CHECK(regions == std::vector<std::size_t>{0, 0, 1, 1});  // the last with what is held out
  CHECK(kept_touch_stage(filled.store) == BodyStage::kFinished);
  CHECK(stages == std::vector<BodyStage>{BodyStage::kFinished, BodyStage::kLinear,
                                         BodyStage::kTables, BodyStage::kFinished});
}

TEST_CASE("tables of a finer skin are made on a coarser mesh that carries it",
          "[pipeline][touch][long]") {
  const ScratchFolder folder("bake_touch");
  BodyDescription egg = test::egg_body(folder.path(), 2);
  const FilledStore filled = fill(egg, folder / "egg.snapshots");
  ReducedBody body = reduce_store(filled.store, {}).body;
  const double edge = 1.7 * mean_edge_length(body.surface);
  egg.touch = {.tables = Tables::kLinear, .edge = edge, .held_out = 2};
  bake_touch(egg, filled.plan, filled.store, 2, [&](const TouchTables& tables, BodyStage) {
    body.provenance.touch = touch_line(tables);
    write_touchable_body(folder / "egg.palpable", body, tables);
  });
  const TouchableBody read = value_or_throw(read_touchable_body(folder / "egg.palpable"));
  REQUIRE(read.touch);
  REQUIRE(read.touch->coarse);
  const SurfaceMesh& coarse = read.touch->coarse->surface;
  CHECK(coarse.vertex_count() < body.surface.vertex_count() / 2);
  CHECK(std::abs(mean_edge_length(coarse) - edge) < 0.15 * edge);
  CHECK(read.touch->compliance.vertices == coarse.vertex_count());
  CHECK(read.touch->held_out.size() == 2);
  // `reduce` finds them, with their skin.
  const auto kept = kept_touch_tables(filled.store);
  REQUIRE((kept && kept->coarse));
  CHECK(kept->coarse->surface.vertices == coarse.vertices);
  CHECK(kept->coarse->fixed == read.touch->coarse->fixed);
}

TEST_CASE("where no coarser mesh can be made the body has no tables, and the reason is returned",
          "[pipeline][touch][long]") {
  const ScratchFolder folder("bake_touch");
  BodyDescription egg = test::egg_body(folder.path(), 2);
  const FilledStore filled = fill(egg, folder / "egg.snapshots");
  CampaignPlan fine = filled.plan;
  fine.boundary.surface = sphere_surface({0, 0, 0.04}, 0.04, 5);
  egg.supports[0].where.what = Where::Named{"BASE"};
  int uses = 0;
  const auto why = [&](const BodyDescription::Touch& wanted) {
    egg.touch = wanted;
    return bake_touch(egg, fine, filled.store, 2, [&](const TouchTables&, BodyStage) { ++uses; });
  };
  CHECK_THAT(why({}), Catch::Contains("10242 vertices") && Catch::Contains("no sets"));
  CHECK(why({.tables = Tables::kNone}).empty());
  CHECK_THROWS_WITH(why({.tables = Tables::kLinear, .by_default = false}),
                    Catch::Contains("no sets"));
  CHECK(uses == 0);
}

}  // namespace
}  // namespace palpable
