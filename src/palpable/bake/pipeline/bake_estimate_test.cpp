#include "palpable/bake/pipeline/bake_estimate.h"

#include "palpable/bake/pipeline/bake_counts.h"
#include "tests/support/beam_description.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <filesystem>
#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::WithinRel;
using test::ScratchFolder;
using Tables = BodyDescription::Touch::Tables;

constexpr double kRounding = 1e-12;

double seconds_of(const std::vector<BakeStage>& stages, const std::string& name) {
  for (const BakeStage& stage : stages) {
    if (stage.name == name) return stage.cpu_seconds;
  }
  return 0;
}

// A campaign of 2 sites, 10 levels and 3 values of a parameter.
BakeCounts small_campaign() {
  BakeCounts counts{.body = {.nodes = 1000, .tets = 4000, .points = 4000, .vertices = 100}};
  counts.sites = 2;
  counts.levels = 10;
  counts.points = 3;
  counts.mode_nodes = 100;
  counts.displacement_modes = 10;
  counts.stress_modes = 20;
  return counts;
}

TEST_CASE("nodes, elements, sites and values of a description are counted before it is baked",
          "[pipeline][estimate]") {
  const ScratchFolder folder("bake_estimate");
  const auto counts_with = [&](const std::string& more) {
    const BodyDescription beam =
        test::describe_small_beam(folder.path(), "[press]\nforce = \"1 N\"\nlevels = 4\n" + more);
    return count_bake(beam, {}).counts;
  };
  // 16 x 6 x 2 cells of six tetrahedra: 17 x 7 x 3 nodes, 15 x 5 of them inside. The set TOP has
  // 16 x 7 nodes.
  const BakeCounts counts = counts_with("[touch]\ntables = \"none\"\n");
  CHECK(counts.body.nodes == 357);
  CHECK(counts.body.tets == 1152);
  CHECK(counts.body.points == 1152);
  CHECK(counts.body.vertices == 282);
  CHECK_THAT(counts.body.volume, WithinRel(0.40 * 0.10 * 0.05, 1e-9));
  CHECK(counts.sites == 112);
  CHECK(counts.levels == 4);
  CHECK(counts.points == 1);
  CHECK(!counts.touch);
  CHECK(!counts.intrusive);
  // The factor has at least the lower half of the stiffness of 336 free nodes.
  CHECK(counts.body.factor_numbers > 336 * 6);

  const BakeCounts varied = counts_with(
      "[[parameter]]\nname = \"soft\"\nof = \"body\"\nstiffness = [0.5, 1, 2]\n"
      "[[parameter]]\nname = \"nu\"\nof = \"body\"\npoisson = [0.2, 0.3]\n");
  CHECK(varied.points == 6);
  CHECK(varied.linear == 0);
}

TEST_CASE("positions of a travelling load are counted without those near the support",
          "[pipeline][estimate][intrusive]") {
  const ScratchFolder folder("bake_estimate");
  const BodyDescription beam = test::describe_small_beam(
      folder.path(), "[intrusive]\npositions = [\"TOP\"]\nforce = \"1 N\"\nmodes = 500\n");
  const CountedBake counted = count_bake(beam, {.with_campaign = false});
  REQUIRE(counted.counts.intrusive);
  // Patches reach 0.030 m, the diagonal of a cell of 25 x 16.7 mm: the columns at x = 25 and 50 mm
  // are within twice that.
  CHECK(counted.counts.intrusive->positions == 112 - 2 * 7);
  CHECK(counted.counts.intrusive->modes == counted.counts.intrusive->positions);
  CHECK(counted.counts.intrusive->energy_modes == 0);
  CHECK(counted.counts.sites == 0);
  CHECK(!counted.counts.touch);
  CHECK(estimate_of(counted.counts, counted.costs, 8).threads == 1);
}

TEST_CASE("tables of touch are counted as they will be made", "[pipeline][estimate][touch]") {
  const ScratchFolder folder("bake_estimate");
  BodyDescription egg = test::egg_body(folder.path(), 2);
  egg.touch = {.tables = Tables::kFull, .regions = 3, .cross_modes = 32, .held_out = 2};
  const CountedBake full = count_bake(egg, {});
  REQUIRE(full.counts.touch);
  CHECK(full.counts.touch->regions == 3);
  CHECK(full.counts.touch->cross_modes == 32);
  CHECK(full.counts.touch->held_out == 2);
  CHECK(full.costs.touch.solve > 0);
  CHECK(full.costs.touch.factor > 0);
  CHECK(full.costs.touch.pass > 0);
  CHECK(full.costs.flop > 0);
  egg.touch.tables = Tables::kLinear;
  const BakeCounts linear = count_bake(egg, {}).counts;
  CHECK(linear.touch->regions == 0);
  CHECK(linear.touch->cross_modes == 0);
  CHECK(linear.touch->table_bytes < full.counts.touch->table_bytes);
  // One part of a campaign makes no tables.
  CHECK(!count_bake(egg, {.fill = {.shard = 1, .shards = 2}}).counts.touch);
}

TEST_CASE("a campaign costs the iterations of its sites, shared by the threads",
          "[pipeline][estimate]") {
  const BakeCounts counts = small_campaign();
  BakeCosts costs{.mesh = 5, .body = {.factor = 2, .solve = 0, .pass = 1}};
  const std::vector<BakeStage> stages = stages_of(counts, costs);
  CHECK(seconds_of(stages, "mesh") == 5);
  CHECK_THAT(seconds_of(stages, "factors"), WithinRel(3 * 0.5 * 2, kRounding));
  // 2 x 3 paths of 90 + 10 x 10.5 iterations, each of which is one pass.
  CHECK_THAT(seconds_of(stages, "sites"), WithinRel(6 * 195.0, kRounding));
  // Displacement and stress, 36 bytes a node, level and path.
  CHECK(estimate_of(counts, costs, 1).snapshot_bytes == 36.0 * 1000 * 10 * 6);

  const BakeEstimate one = estimate_of(counts, costs, 1), four = estimate_of(counts, costs, 4);
  CHECK_THAT(one.seconds, WithinRel(one.cpu_seconds, kRounding));
  CHECK_THAT(four.cpu_seconds, WithinRel(one.cpu_seconds, kRounding));
  CHECK_THAT(one.seconds - four.seconds, WithinRel(0.75 * 6 * 195.0, kRounding));

  costs.body = {.factor = 2, .solve = 1, .pass = 0};
  CHECK_THAT(seconds_of(stages_of(counts, costs), "sites"), WithinRel(0.44 * 6 * 195.0, kRounding));
  BakeCounts half = counts;
  half.shards = 2;
  CHECK_THAT(seconds_of(stages_of(half, costs), "sites"), WithinRel(0.22 * 6 * 195.0, kRounding));
  CHECK(file_bytes_of(half) == 0);
}

TEST_CASE("a body file has its skin, its modes and its tables", "[pipeline][estimate]") {
  BakeCounts counts = small_campaign();
  // 100 nodes with 3 numbers of 10 modes and 6 of 20, and 60 bytes for each vertex.
  CHECK(file_bytes_of(counts) == 50e3 + 6e3 + 4 * 100 * 150);
  counts.bytes_of_number = 2;
  CHECK(file_bytes_of(counts) == 50e3 + 6e3 + 2 * 100 * 150);
  counts.touch = TouchCounts{.table_bytes = 1e6};
  CHECK(file_bytes_of(counts) == 50e3 + 6e3 + 2 * 100 * 150 + 1e6);
}

TEST_CASE("memory is that of the sites in progress", "[pipeline][estimate]") {
  BakeCounts counts = small_campaign();
  counts.sites = 4;
  counts.points = 1;
  counts.body.factor_numbers = 1e5;
  // A site: 24 bytes a node and level, and 1500 a node; 60 a node and level where one is written.
  const double sites = 4 * 1000 * 1740.0, written = 60 * 1000 * 10.0;
  CHECK_THAT(memory_of(counts, 1), WithinRel(90e6 + 6e5 + 4e6 + sites + written, kRounding));
  counts.sites = 40;  // 20 at a time for each thread
  CHECK_THAT(memory_of(counts, 2),
             WithinRel(90e6 + 6e5 + 4e6 + 10 * sites + 2 * written, kRounding));
}

TEST_CASE("modes are fewer where the tolerance is coarse, and no more than levels",
          "[pipeline][estimate]") {
  CHECK_THAT(expected_modes(1e-4, 10).displacement, WithinRel(3.8, kRounding));
  CHECK_THAT(expected_modes(1e-4, 10).stress, WithinRel(4.8, kRounding));
  CHECK_THAT(expected_modes(1e-3, 10).displacement, WithinRel(2.3, kRounding));
  CHECK(expected_modes(1e-4, 2).stress == 2);
  CHECK(expected_modes(1, 10).displacement == 1);
}

TEST_CASE("an estimate is three lines for people", "[pipeline][estimate]") {
  const BakeEstimate estimate{.threads = 2,
                              .seconds = 240,
                              .cpu_seconds = 400,
                              .memory_bytes = 1.2e9,
                              .file_bytes = 90e6,
                              .snapshot_bytes = 30e6};
  CHECK(text_of(estimate) ==
        "time    about 4 min on 2 cores (2.0 to 8 min)\n"
        "memory  about 1.2 GB (600 MB to 2.4 GB)\n"
        "file    about 90 MB, and 30 MB of snapshots (45 to 180 MB)\n");
  const Json json = json_of(estimate);
  CHECK(json["seconds"].get<double>() == 240.0);
  CHECK(json["cpu_seconds"].get<double>() == 400.0);
  CHECK(json["memory_bytes"].get<double>() == 1.2e9);
  CHECK(json["file_bytes"].get<double>() == 90e6);
  const BakeEstimate part{.threads = 1, .seconds = 5, .snapshot_bytes = 30e6};
  CHECK_THAT(text_of(part),
             Contains("about 5 s on 1 core ") && Contains("30 MB of snapshots, no body file"));
}

}  // namespace
}  // namespace palpable
