#include "palpable/bake/pipeline/bake_estimate.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/touch_bake/compliance_maker.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/common/base/contract.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

namespace palpable {
namespace {

// Everything that is not counted. Measured on 2026-11-29 by bakes with --threads 1 on a Xeon at
// 2.80 GHz whose two cores other programs kept busy, in units of the costs that count_bake() found
// there in the same hour:
//
//     body                                nodes   CPU s  estimated   MB of memory  estimated
//     post-small.toml                       632      17         18            279        222
//     post.toml                             989      95        105            416        373
//     bunny-demo.toml                     3,470     393        376            974        969
//     bunny-stiffness.toml                4,853      19         20            277        246
//     bunny.toml, 3 regions, 3 held out  16,451     568        636          3,532      4,099
//     beam.toml --intrusive              12,803     271        273          3,723      3,216
// They were fitted to the first, third, fifth and sixth; the other two were baked as a check.
struct Model {
  // A path of a site: iterations of conjugate gradients, of the search for its load and of each
  // level. A site that comes close to collapse takes several times as many.
  static constexpr double search_iterations = 90, level_iterations = 10.5;
  static constexpr double linear_iterations = 11;  // of a linear response
  // An iteration: a 16-bit factor is applied to 16 loads together, and the tangent is multiplied.
  static constexpr double iteration_solves = 0.44, iteration_passes = 1.0;
  static constexpr double solver_factors = 0.5;  // single precision, ratio to MeshCosts::factor
  static constexpr double reduce_s_per_byte = 18e-9;  // of snapshots
  // Products and copies beside the solves of a table.
  static constexpr double table_overhead = 1.15;
  // Points that enter the energy of a region: 4,100 where a cubic metre has 24 million of them, and
  // more of a finer mesh, but not in proportion: most of the energy is then in fewer of them.
  static constexpr double region_points = 4100, region_density = 24e6, region_power = 0.6;
  static constexpr double cross_points = 0.12;  // share of the elements that enter its energy
  static constexpr double eigen_flops = 25;     // n^3 times this: eigenvectors of n x n numbers
  // Vectors of the Lanczos basis of vibration modes, for each that is asked for: there are as many
  // again below 60 Hz in a body like the bunny. Solves of eight together cost more each than the 48
  // of MeshCosts; the basis is multiplied with each of its vectors three times.
  static constexpr double lanczos_per_mode = 6, lanczos_least = 50;
  static constexpr double lanczos_solves = 1.8, lanczos_products = 12;
  // One held-out touch, in factors: 13 where a square metre of the skin has 22,000 vertices, and
  // more of a finer skin, since more of its points are in contact.
  static constexpr double held_out_factors = 13, skin_density = 22e3, skin_power = 0.42;
  // The power series of a load.
  static constexpr double series_orders = 8.5, order_passes = 1.0;
  static constexpr double separate_flops = 440;  // per node, position, order and greedy mode
  static constexpr double several_solves = 420;  // loads from which the energy's modes are made
  static constexpr double products_u = 1.6, products_sigma = 0.75;  // in the file, for each mode
};

double iteration(const MeshCosts& costs) {
  return Model::iteration_solves * costs.solve + Model::iteration_passes * costs.pass;
}

double snapshot_bytes_of(const BakeCounts& counts) {
  if (counts.intrusive) return 0;
  // Displacement and stress, nine numbers of four bytes; linear responses on the skin.
  const double units = 1.0 * counts.sites * counts.points / counts.shards;
  return 36.0 * counts.body.nodes * counts.levels * units * (counts.held_out ? 2 : 1) +
         12.0 * counts.body.vertices * counts.linear / counts.shards;
}

// Operations of the stored energy in r modes, s of them to the fourth degree, for each point
// (modal_forms.cpp): products of pairs of gradients with the law's derivatives, then with
// gradients.
double form_flops(double r, double s) {
  const double pairs = r * (r + 1) / 2, few = s * (s + 1) / 2;
  return pairs * (2 * 45 * 9 + 2 * 9 * r) + few * (2 * 45 * 45 + 2 * 45 * few);
}

void add_campaign(const BakeCounts& counts, const BakeCosts& costs,
                  std::vector<BakeStage>& stages) {
  const double units = 1.0 * counts.sites * counts.points / counts.shards;
  double iterations = units * (Model::search_iterations + Model::level_iterations * counts.levels);
  if (counts.held_out) iterations += units * Model::level_iterations * counts.levels;
  stages.push_back({"factors", counts.points * Model::solver_factors * costs.body.factor, false});
  stages.push_back({"sites", iterations * iteration(costs.body), true});
  if (counts.linear > 0) {
    stages.push_back({"linear responses",
                      counts.linear / static_cast<double>(counts.shards) *
                          Model::linear_iterations * iteration(costs.body),
                      true});
  }
  if (counts.shards > 1) return;
  stages.push_back({"reduce", Model::reduce_s_per_byte * snapshot_bytes_of(counts), false});
}

void add_tables(const TouchCounts& touch, const MeshCosts& costs, double flop,
                std::vector<BakeStage>& stages) {
  const RegionSettings region{};
  const CrossSettings cross{};
  const double rows = 3.0 * touch.mesh.nodes;
  stages.push_back({"factors of the tables", (1 + Model::solver_factors) * costs.factor, false});
  const double passes = 3.0 * 240;
  const double linear =
      (solves_of_bases(touch.mesh.vertices - touch.held) + 3.0 * touch.mesh.vertices) *
          costs.solve +
      passes * costs.pass;
  stages.push_back({"compliance", Model::table_overhead * linear, true});
  if (touch.vibration_modes > 0) {
    const double vectors = Model::lanczos_per_mode * touch.vibration_modes + Model::lanczos_least;
    stages.push_back({"vibration modes",
                      Model::lanczos_solves * vectors * costs.solve +
                          touch.vibration_modes * costs.pass +
                          Model::lanczos_products * flop * vectors * vectors * rows,
                      false});
  }
  if (touch.regions > 0) {
    const double loads = 2.0 * region.loads;
    const double points = std::min<double>(
        touch.mesh.points, Model::region_points * std::pow(touch.mesh.points / touch.mesh.volume /
                                                               Model::region_density,
                                                           Model::region_power));
    const double one = Model::table_overhead * (loads * costs.solve + region.loads * costs.pass) +
                       flop * (2 * loads * loads * rows + 2 * loads * region.modes * rows +
                               Model::eigen_flops * std::pow(loads, 3) +
                               points * form_flops(region.modes, region.leading));
    stages.push_back({"large loads", touch.regions * one, true});
  }
  if (touch.cross_modes > 0) {
    const double fields = 3.0 * cross.places + cross.pairs;
    const double all =
        Model::table_overhead * (fields * costs.solve + 3.0 * cross.pairs * costs.pass) +
        flop * (fields * fields * rows + 4 * fields * touch.cross_modes * rows +
                Model::eigen_flops * std::pow(fields, 3) +
                Model::cross_points * touch.mesh.points * form_flops(touch.cross_modes, 0));
    stages.push_back({"cross terms", all, true});
  }
  if (touch.held_out > 0) {
    const double density = touch.mesh.vertices / touch.mesh.area / Model::skin_density;
    const double factors = Model::held_out_factors * std::pow(density, Model::skin_power);
    stages.push_back({"held-out touches", touch.held_out * factors * costs.factor, true});
  }
}

void add_intrusive(const BakeCounts& counts, const BakeCosts& costs,
                   std::vector<BakeStage>& stages) {
  const IntrusiveCounts& travelling = *counts.intrusive;
  const double fields = Model::series_orders * travelling.positions;
  stages.push_back({"factors", costs.body.factor, false});
  stages.push_back(
      {"series", fields * (costs.body.solve + Model::order_passes * costs.body.pass), false});
  const double greedy = 1.2 * travelling.modes + 2;
  const double separate = Model::separate_flops * fields * greedy * counts.body.nodes;
  stages.push_back({"separate", costs.flop * separate, false});
  if (travelling.energy_modes == 0) return;
  // Seven strains an element of each mode and pair of modes, and the products of all of them.
  const double n = travelling.energy_modes, strains = n + n * (n + 1) / 2;
  stages.push_back({"several loads",
                    costs.flop * 7 * counts.body.tets * strains * strains +
                        Model::several_solves * costs.body.solve,
                    false});
}

// Memory of the program itself and of reading and meshing a body, bytes.
constexpr double kProgram = 90e6;

double campaign_memory(const BakeCounts& counts, int threads) {
  const double nodes = counts.body.nodes;
  const double a_lane = nodes * (24.0 * counts.levels + kBytesPerNodeOfCall);
  // As many sites in progress as site_run.cpp has.
  const double lanes =
      std::min({std::max(1.0 * threads, 2e9 / a_lane), 20.0 * threads, 1.0 * counts.sites});
  // Bytes: 2 + 4 for each number of the factor, which is kept in 16 bits and made in single
  // precision; 4,000 for each node's part of the matrix.
  return 6 * counts.body.factor_numbers + 4000 * nodes + lanes * a_lane +
         60 * nodes * counts.levels * std::min<double>(threads, counts.sites);
}

double touch_memory(const TouchCounts& touch, int threads) {
  const double rows = 3.0 * touch.mesh.nodes;
  const double factors = 10 * touch.mesh.factor_numbers + 8000.0 * touch.mesh.nodes;
  const double samples = solves_of_bases(touch.mesh.vertices - touch.held);
  const double bases = 3.0 * touch.mesh.vertices * samples * 8 +
                       3.0 * (touch.shell - touch.mesh.vertices) * samples * 4;
  const CrossSettings cross{};
  const RegionSettings region{};
  // Loads and displacements of cross terms stand in three pairs of tables, then in modes.
  const double pairs = 0.5 * touch.cross_modes * (touch.cross_modes + 1);
  const double at_cross =
      touch.cross_modes > 0
          ? 8 * rows * (4.0 * (3.0 * cross.places + cross.pairs) + 2 * touch.cross_modes) +
                12 * pairs * touch.cross_modes + 4 * pairs * (45 + 9 * 32)
          : 0;
  const double loads = 2.0 * region.loads;
  const double at_region = touch.regions > 0 ? rows * loads * (8 + 16) : 0;
  return factors + touch.table_bytes +
         std::max(bases, std::max(at_cross, at_region) + (threads - 1) * at_region);
}

double intrusive_memory(const BakeCounts& counts) {
  const IntrusiveCounts& travelling = *counts.intrusive;
  const double states = 3.0 * travelling.positions;
  return 8 * counts.body.factor_numbers +
         12.0 * counts.body.nodes * travelling.positions * (Model::series_orders - 1) +
         4 * 6.0 * counts.body.vertices * states +
         48.0 * 16 * counts.body.tets * 1.5 * Model::series_orders;
}

}  // namespace

std::vector<BakeStage> stages_of(const BakeCounts& counts, const BakeCosts& costs) {
  std::vector<BakeStage> stages{{"mesh", costs.mesh, false}};
  if (counts.intrusive) {
    add_intrusive(counts, costs, stages);
    return stages;
  }
  add_campaign(counts, costs, stages);
  if (counts.touch && counts.shards == 1)
    add_tables(*counts.touch, costs.touch, costs.flop, stages);
  return stages;
}

double memory_of(const BakeCounts& counts, int threads) {
  PALPABLE_EXPECT(threads >= 1, "at least one thread");
  if (counts.intrusive) return kProgram + intrusive_memory(counts);
  const double reduce = std::min(200e6, 2 * snapshot_bytes_of(counts));
  const double touch = counts.touch ? touch_memory(*counts.touch, threads) : 0;
  // What the campaign has freed is rarely given back to the system.
  return kProgram + std::max(campaign_memory(counts, threads), reduce) + touch;
}

double file_bytes_of(const BakeCounts& counts) {
  if (counts.shards > 1) return 0;
  // Positions, normals' triangles and patches of the skin.
  const double skin = 60.0 * counts.body.vertices;
  double modes = 0;
  if (const auto& travelling = counts.intrusive) {
    // Each mode stands in the file once for each of its products, with its function of the
    // position.
    const double u = Model::products_u * travelling->modes;
    const double sigma = Model::products_sigma * travelling->stress_modes;
    const double nodes = std::max(counts.body.vertices, travelling->shell);
    modes = counts.body.vertices * (3 * u + 6 * sigma) * counts.bytes_of_number +
            8.0 * travelling->positions * (u + sigma) + 12 * nodes * travelling->energy_modes +
            travelling->shell_bytes;
  } else {
    modes = counts.mode_nodes * (3 * counts.displacement_modes + 6 * counts.stress_modes) *
            counts.bytes_of_number;
  }
  return 50e3 + skin + modes + (counts.touch ? counts.touch->table_bytes : 0);
}

BakeEstimate estimate_of(const BakeCounts& counts, const BakeCosts& costs, int threads) {
  BakeEstimate estimate{.threads = counts.intrusive ? 1 : threads,
                        .memory_bytes = memory_of(counts, threads),
                        .file_bytes = file_bytes_of(counts),
                        .snapshot_bytes = snapshot_bytes_of(counts),
                        .stages = stages_of(counts, costs)};
  for (const BakeStage& stage : estimate.stages) {
    estimate.cpu_seconds += stage.cpu_seconds;
    estimate.seconds += stage.cpu_seconds / (stage.parallel ? threads : 1);
  }
  return estimate;
}

namespace {

// In whole units, below 3 of them with one more digit: "8 s", "2.5 min", "4 h".
std::string duration_about(double seconds) {
  const auto [size, unit] = seconds < 100    ? std::pair{1.0, "s"}
                            : seconds < 6000 ? std::pair{60.0, "min"}
                                             : std::pair{3600.0, "h"};
  const double value = std::max(1.0 / size, seconds / size);
  return fmt::format(fmt::runtime(value < 2.95 ? "{:.1f} {}" : "{:.0f} {}"), value, unit);
}

std::string bytes_about(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", std::max(1.0, bytes / 1e6))
                     : fmt::format("{:.1f} GB", bytes / 1e9);
}

// "2 to 8 min", or "50 s to 3 min" where the units differ.
std::string range_about(const std::string& least, const std::string& most) {
  const std::size_t unit = least.find(' ');
  const bool alike = least.substr(unit) == most.substr(most.find(' '));
  return fmt::format("{} to {}", alike ? least.substr(0, unit) : least, most);
}

template <class Text>
std::string figure_line(const char* what, double value, const Text& text, const std::string& more) {
  constexpr double kFactor = BakeEstimate::kFactor;
  return fmt::format("{:<7} about {}{} ({})\n", what, text(value), more,
                     range_about(text(value / kFactor), text(value * kFactor)));
}

}  // namespace

std::string text_of(const BakeEstimate& estimate) {
  const std::string cores =
      fmt::format(" on {} {}", estimate.threads, estimate.threads == 1 ? "core" : "cores");
  std::string text = figure_line("time", estimate.seconds, duration_about, cores);
  text += figure_line("memory", estimate.memory_bytes, bytes_about, "");
  std::string beside;
  if (estimate.snapshot_bytes > 0) {
    beside = fmt::format(", and {} of snapshots", bytes_about(estimate.snapshot_bytes));
  }
  if (estimate.file_bytes > 0)
    return text + figure_line("file", estimate.file_bytes, bytes_about, beside);
  return text +
         figure_line("file", estimate.snapshot_bytes, bytes_about, " of snapshots, no body file");
}

Json json_of(const BakeEstimate& estimate) {
  Json stages = Json::object();
  for (const BakeStage& stage : estimate.stages) stages[stage.name] = stage.cpu_seconds;
  return {{"seconds", estimate.seconds},
          {"cpu_seconds", estimate.cpu_seconds},
          {"memory_bytes", std::round(estimate.memory_bytes)},
          {"file_bytes", std::round(estimate.file_bytes)},
          {"snapshot_bytes", std::round(estimate.snapshot_bytes)},
          {"threads", estimate.threads},
          {"factor", BakeEstimate::kFactor},
          {"stages", std::move(stages)}};
}

}  // namespace palpable
