#include "palpable/bake/pipeline/bake_to_file.h"

#include "palpable/bake/campaign/solid_file.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/touch_file.h"
#include "tests/support/beam_description.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

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
