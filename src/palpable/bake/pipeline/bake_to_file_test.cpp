#include "palpable/bake/pipeline/bake_to_file.h"

#include "palpable/bake/campaign/solid_file.h"
#include "palpable/bake/pipeline/solution_service.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/beam_description.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <stdexcept>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using Tables = BodyDescription::Touch::Tables;

BakeToFileSettings egg_settings(const fs::path& folder, const std::string& command_line) {
  return {.output = folder / "egg.palpable",
          .fill = {.threads = 2, .store = folder / "egg.snapshots"},
          .reduction = {.version = "test 1", .command_line = command_line}};
}

TEST_CASE("a description gives the same file each time, but for its provenance",
          "[pipeline][body][provenance]") {
  const test::ScratchFolder folder("bake_to_file");
  BodyDescription egg = test::egg_body(folder.path(), 3);
  egg.touch = {.tables = Tables::kLinear, .held_out = 0};
  LocalCrew crew;
  std::vector<TouchableBody> bodies;
  for (const char* command_line : {"palpable bake egg.toml", "palpable bake ./egg.toml"}) {
    const BakeToFileSettings settings = egg_settings(folder.path(), command_line);
    const auto baked = bake_to_file(egg, settings, crew);
    REQUIRE((baked && baked->campaign && baked->body && !baked->intrusive));
    CHECK_THAT(baked->touch, Contains("anywhere"));
    CHECK(baked->campaign->campaign.solved == (bodies.empty() ? 2 : 0));
    bodies.push_back(value_or_throw(read_touchable_body(settings.output)));
    const Provenance& provenance = bodies.back().body.provenance;
    CHECK(provenance.description == "egg.toml");
    CHECK(provenance.sites_reached == 2);
    CHECK_THAT(provenance.touch, Contains("compliance of "));
    CHECK(provenance.program == "test 1");
    CHECK(provenance.command_line == command_line);
  }
  CHECK_FALSE(bodies[0].body.provenance == bodies[1].body.provenance);
  bodies[1].body.provenance = bodies[0].body.provenance;
  for (std::size_t k = 0; k < 2; ++k) {
    write_touchable_body(folder.path() / std::to_string(k), bodies[k].body, *bodies[k].touch);
  }
  CHECK(test::file_bytes(folder.path() / "0") == test::file_bytes(folder.path() / "1"));
}

struct Stopped : std::runtime_error {
  Stopped() : std::runtime_error("stopped") {}
};

// Bakes until progress is reported for the n-th time with the output at a stage, then stops.
std::vector<std::optional<BodyStage>> stages_seen(const BodyDescription& egg,
                                                  const BakeToFileSettings& settings,
                                                  std::optional<BodyStage> stop_at) {
  std::vector<std::optional<BodyStage>> seen;
  LocalCrew crew;
  const auto look = [&](const ProgressReport&) {
    const std::optional<BodyStage> now = stage_of_file(settings.output);
    if (seen.empty() || seen.back() != now) seen.push_back(now);
    if (stop_at && now == stop_at) throw Stopped();
  };
  try {
    static_cast<void>(bake_to_file(egg, settings, crew, look));
    seen.push_back(stage_of_file(settings.output));
  } catch (const Stopped&) {}
  return seen;
}

TEST_CASE(
    "a first bake publishes its stages, and a finished body stays until a better one is there",
    "[pipeline][body][stages][long]") {
  const test::ScratchFolder folder("bake_to_file");
  BodyDescription egg = test::egg_body(folder.path(), 2);
  egg.touch = {.tables = Tables::kFull, .regions = 1, .held_out = 1};
  const BakeToFileSettings settings = egg_settings(folder.path(), "");
  CHECK_FALSE(stage_of_file(settings.output));

  // Stopped with linear tables, and taken up there.
  const auto first = stages_seen(egg, settings, BodyStage::kLinear);
  CHECK(first.front() == std::nullopt);
  CHECK(first.back() == BodyStage::kLinear);
  CHECK(value_or_throw(read_touchable_body(settings.output)).touch.has_value());
  CHECK_THAT(std::string(missing_at(BodyStage::kLinear)), Contains("small touches"));
  CHECK_NOTHROW(expect_no_later_stage(settings.output, BodyStage::kLinear));
  for (const auto& stage : stages_seen(egg, settings, std::nullopt)) {
    CHECK(stage >= BodyStage::kLinear);  // it never falls back to a body without tables
  }
  CHECK(stage_of_file(settings.output) == BodyStage::kFinished);
  CHECK_THROWS_WITH(expect_no_later_stage(settings.output, BodyStage::kLinear),
                    Contains("egg.palpable: holds a body that is baked further"));
  CHECK_NOTHROW(expect_no_later_stage(settings.output, BodyStage::kFinished));
  // A body without tables replaces it only where its own description asks for none now.
  CHECK_THROWS_WITH(expect_no_lost_tables(settings.output),
                    Contains("egg.palpable: holds the finished body") &&
                        Contains("tables of touch") && Contains("--overwrite"));
  CHECK_THROWS_WITH(expect_no_lost_tables(settings.output, "another"), Contains("--overwrite"));
  CHECK_NOTHROW(expect_no_lost_tables(settings.output, egg.name));
  CHECK_NOTHROW(expect_no_lost_tables(folder.path() / "none.palpable"));
  const ReducedBody body = value_or_throw(read_body_file(settings.output));
  CHECK(other_body_text(egg, body).empty());
  BodyDescription stiff = egg;
  stiff.material.young *= 1000;
  CHECK_THAT(other_body_text(stiff, body),
             Contains("another body than") && Contains("its material is"));
  BodyDescription coarse = egg;
  coarse.shape.edge = 3.0 * mean_edge_length(body.surface);
  CHECK_THAT(other_body_text(coarse, body), Contains("another mesh than"));

  // Another description into the same file, stopped at every report of a stage: none is published.
  const std::string finished = test::file_bytes(settings.output);
  BodyDescription other = egg;
  other.material.young *= 2;
  LocalCrew crew;
  for (const int stop : {2, 8, 20, 40, 80}) {
    int left = stop;
    bool stayed = true;
    try {
      static_cast<void>(bake_to_file(other, settings, crew, [&](const ProgressReport&) {
        stayed = stayed && test::file_bytes(settings.output) == finished;
        if (--left == 0) throw Stopped();
      }));
      break;
    } catch (const Stopped&) { CHECK(test::file_bytes(settings.output) == finished); }
    CHECK(stayed);
  }
  static_cast<void>(bake_to_file(other, settings, crew));
  CHECK(stage_of_file(settings.output) == BodyStage::kFinished);
  CHECK_FALSE(test::file_bytes(settings.output) == finished);
}

TEST_CASE("a shard is solved only; a complete bake takes it up", "[pipeline][body]") {
  const test::ScratchFolder folder("bake_to_file");
  BodyDescription egg = test::egg_body(folder.path(), 3);
  egg.touch = {.tables = Tables::kNone, .by_default = false};
  BakeToFileSettings settings = egg_settings(folder.path(), "");
  settings.fill.shards = 2;
  LocalCrew crew;
  const auto shard = bake_to_file(egg, settings, crew);
  REQUIRE((shard && shard->campaign && !shard->body));
  CHECK(shard->campaign->campaign.solved == 1);
  CHECK_FALSE(fs::exists(settings.output));
  settings.fill.shards = 1;
  settings.held_out = true;
  const auto whole = bake_to_file(egg, settings, crew);
  REQUIRE((whole && whole->body));
  CHECK(whole->campaign->campaign.solved == 1);
  CHECK(whole->touch == "at its sites, one at a time");
  const ReducedBody body = value_or_throw(read_body_file(settings.output));
  REQUIRE(body.error.held_out.has_value());
  CHECK_THAT(body.provenance.held_out, Contains("against 6 levels between"));
}

TEST_CASE("a bake without a campaign writes the body and its solid", "[pipeline][intrusive]") {
  const test::ScratchFolder folder("bake_to_file");
  BodyDescription beam = test::describe_small_beam(
      folder.path(),
      "[intrusive]\npositions = [\"TOP\"]\nforce = \"2 N\"\nmodes = 4\nstress_modes = 8\n");
  const BakeToFileSettings settings{.output = folder.path() / "beam.palpable",
                                    .with_campaign = false,
                                    .reduction = {.version = "test 1", .command_line = "a b"}};
  LocalCrew crew;
  const auto baked = bake_to_file(beam, settings, crew);
  REQUIRE((baked && baked->intrusive && !baked->campaign && !baked->body));
  CHECK(fs::exists(solid_file_of(settings.output)));
  const Provenance provenance = value_or_throw(read_body_file(settings.output)).provenance;
  CHECK(provenance.series == baked->intrusive->provenance.series);
  CHECK(provenance.command_line == "a b");
  CHECK(provenance.description == beam.source.string());
  beam.touch = {.tables = Tables::kLinear};
  beam.touch.by_default = false;
  CHECK_THROWS_WITH(bake_to_file(beam, settings, crew), Contains("[touch] has tables"));
}

}  // namespace
}  // namespace palpable
