// palpable bench campaign: time from a description to all snapshots on disk, in an empty folder.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/bake/solid/sparse_cholesky.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/this_machine.h"

#include <fmt/core.h>

#include "bench/bake/bench.h"
#include "bench/bake/machine_rates.h"
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct BenchCampaignOptions {
  std::string description = "bodies/bunny.toml";
  std::string dense = "bodies/bunny-dense.toml";
  std::string dragon = "bodies/dragon.toml";
  int threads = 0;
  bool all = false;
  bool json = false;
};

// A folder that is empty after construction and removed with its content by the destructor.
class EmptyFolder {
 public:
  explicit EmptyFolder(const std::string& name)
      : path_(fs::temp_directory_path() / fmt::format("palpable-bench-{}-{}", name, ::getpid())) {
    fs::remove_all(path_);
  }
  EmptyFolder(const EmptyFolder&) = delete;
  EmptyFolder& operator=(const EmptyFolder&) = delete;
  ~EmptyFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Outcome {
  double wall_s = 0;  // mesh, loads, solves, stress, writing
  int sites = 0, levels = 0, points = 0;
  int nodes = 0, tets = 0, skin = 0;
  int reaching = 0;  // sites of all points
  long newton_steps = 0, cg_iterations = 0;
  double stored_mb = 0;
  StageTimes wall, threads;
  double floor_s = 0;
};

// s, lower bound of the time of the conjugate-gradient iterations on all cores: each iteration
// reads the elements once, and the factor twice in a pass that is shared by
// CholeskyFactor::kMostTogether iterations.
double campaign_floor(const SolverSetup& setup, long cg_iterations, int threads) {
  const MachineRates machine = measure_machine(std::size_t{64} << 20U);
  const double bytes =
      setup.element_bytes + 2.0 * setup.factor_bytes / CholeskyFactor::kMostTogether;
  return static_cast<double>(cg_iterations) * bytes / machine.bytes_per_s / threads;
}

Outcome solve_campaign(const std::string& file, int threads) {
  using Clock = std::chrono::steady_clock;
  const EmptyFolder folder(fs::path(file).stem().string());
  ProgressBar bar;
  LocalCrew crew;
  const Clock::time_point begin = Clock::now();
  const BodyDescription description = read_body_description(file);
  FillSettings settings;
  settings.threads = threads;
  settings.store = folder.path();
  const FilledStore filled = fill_store(description, settings, crew, bar.progress());
  Outcome outcome;
  outcome.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  bar.finish();
  const StoreContent& content = filled.store.content();
  outcome.sites = content.site_count();
  outcome.levels = content.level_count();
  outcome.points = content.point_count();
  outcome.nodes = content.mesh.node_count();
  outcome.tets = content.mesh.tet_count();
  outcome.skin = static_cast<int>(content.fixed.size());
  outcome.wall = filled.wall;
  outcome.threads = filled.campaign.times;
  for (int u = 0; u < content.unit_count(); ++u) {
    const SiteOutcome site = filled.store.unit(u).outcome;
    outcome.reaching += site.reached_press;
    outcome.newton_steps += site.newton_steps;
    outcome.cg_iterations += site.cg_iterations;
  }
  outcome.floor_s =
      campaign_floor(filled.campaign.setup, outcome.cg_iterations, crew.threads(threads));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder.path())) {
    if (entry.is_regular_file()) outcome.stored_mb += static_cast<double>(entry.file_size()) / 1e6;
  }
  return outcome;
}

void print_campaign(const std::string& file, const Outcome& o) {
  const int states = o.sites * o.levels * o.points;
  fmt::print("{}\n", file);
  fmt::print("  {} nodes, {} tetrahedra, {} vertices on the skin\n", o.nodes, o.tets, o.skin);
  fmt::print("  {} sites x {} levels{}: {} of {} reach the press\n", o.sites, o.levels,
             o.points > 1 ? fmt::format(" x {} materials", o.points) : "", o.reaching,
             o.sites * o.points);
  fmt::print(
      "  {:.1f} s by the clock, {:.0f} ms a state, {:.1f} Newton steps and {:.1f} iterations "
      "each\n",
      o.wall_s, 1e3 * o.wall_s / states, static_cast<double>(o.newton_steps) / states,
      static_cast<double>(o.cg_iterations) / states);
  for (const StageTime& stage : o.wall.stages()) {
    fmt::print("    {:<12} {:8.1f} s\n", stage.name, stage.ms / 1e3);
  }
  fmt::print("  {:.0f} MB of snapshots\n", o.stored_mb);
  fmt::print("  floor, from what the iterations read of memory: {:.1f} s\n", o.floor_s);
}

void bench_campaign(const BenchCampaignOptions& options) {
  const Outcome bunny = solve_campaign(options.description, options.threads);
  const double peak_mb = peak_memory() / 1e6;
  Json result;
  result["bench"] = "campaign";
  result["body"] = options.description;
  result["wall_s"] = bunny.wall_s;
  result["sites"] = bunny.sites;
  result["levels"] = bunny.levels;
  result["nodes"] = bunny.nodes;
  result["tets"] = bunny.tets;
  result["peak_memory_mb"] = peak_mb;
  result["sites_reaching_press"] = bunny.reaching;
  result["newton_steps"] = bunny.newton_steps;
  result["cg_iterations"] = bunny.cg_iterations;
  result["stored_mb"] = bunny.stored_mb;
  result["floor_s"] = bunny.floor_s;
  for (const StageTime& stage : bunny.wall.stages()) {
    result["wall_stages_s"][std::string(stage.name)] = stage.ms / 1e3;
  }
  result["dense_wall_s"] = nullptr;
  result["dragon_wall_s"] = nullptr;
  if (!options.json) print_campaign(options.description, bunny);
  const auto more = [&](const std::string& file, const char* name) {
    const Outcome outcome = solve_campaign(file, options.threads);
    result[fmt::format("{}_wall_s", name)] = outcome.wall_s;
    result[fmt::format("{}_sites", name)] = outcome.sites;
    result[fmt::format("{}_levels", name)] = outcome.levels;
    result[fmt::format("{}_nodes", name)] = outcome.nodes;
    result[fmt::format("{}_skin_vertices", name)] = outcome.skin;
    result[fmt::format("{}_sites_reaching_press", name)] = outcome.reaching;
    if (!options.json) print_campaign(file, outcome);
  };
  if (options.all) {
    more(options.dense, "dense");
    more(options.dragon, "dragon");
  }
  result["cores"] = std::thread::hardware_concurrency();
  result["processor"] = processor_name();
  result["date"] = date_today();
  if (options.json) {
    fmt::print("{}\n", result.dump(2));
    return;
  }
  fmt::print("peak memory of the first: {:.0f} MB; {}\n", peak_mb, processor_name());
}

}  // namespace

void add_bench_campaign(Command bench) {
  const auto options = std::make_shared<BenchCampaignOptions>();
  Command command = bench.add_subcommand(
      "campaign", "Solve a campaign into an empty folder: mesh, loads, states, stress, files");
  command.add_option("body", options->description, "What to solve")
      .type_name("FILE.toml")
      .show_default();
  command.add_flag("--all", options->all,
                   "Also bodies/bunny-dense.toml and bodies/dragon.toml (tools/setup.sh bodies)");
  add_threads(command, options->threads, "Cores to use; results do not depend on it");
  command.add_json(options->json);
  command.footer("Example: palpable-bake bench campaign --json");
  command.callback([options] { bench_campaign(*options); });
}

}  // namespace palpable::app
