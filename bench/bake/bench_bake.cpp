// palpable bench bake: measures the times of the stages of a bake.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/common/base/json.h"
#include "palpable/common/body_file/body_file.h"

#include <fmt/core.h>

#include "bench/bake/bench.h"
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <unistd.h>

namespace palpable::app {
namespace {

struct BenchBakeOptions {
  std::string description = "bodies/bunny-demo.toml";
  int threads = 0;
  bool json = false;
};

void bench_bake(const BenchBakeOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const BodyDescription description = read_body_description(options.description);
  ProgressBar bar;
  BakedBody baked = bake_body(
      description, {.threads = options.threads, .version = {}, .command_line = {}}, bar.progress());
  bar.finish();
  BakeReport& report = baked.report;
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     fmt::format("palpable-bench-{}.palpable", ::getpid());
  {
    const StageTimer timer(report.wall, "write");
    write_body_file(file, baked.body);
  }
  std::filesystem::remove(file);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;

  Json result;
  result["body"] = baked.body.name;
  result["wall_s"] = wall.count();
  for (const StageTime& stage : report.wall.stages()) {
    result["wall_stages_s"][std::string(stage.name)] = stage.ms / 1000.0;
  }
  for (const StageTime& stage : report.threads.stages()) {
    result["thread_stages_s"][std::string(stage.name)] = stage.ms / 1000.0;
  }
  result["cores"] = std::thread::hardware_concurrency();
  result["nodes"] = report.nodes;
  result["tets"] = report.tets;
  result["sites"] = baked.body.sites.size();
  result["levels"] = baked.body.levels().size() - 1;
  result["sites_reaching_press"] =
      std::count_if(report.outcomes.begin(), report.outcomes.end(),
                    [](const SiteOutcome& o) { return o.reached_press; });
  int newton_steps = 0, cg_iterations = 0;
  for (const SiteOutcome& outcome : report.outcomes) {
    newton_steps += outcome.newton_steps;
    cg_iterations += outcome.cg_iterations;
  }
  result["newton_steps"] = newton_steps;
  result["cg_iterations"] = cg_iterations;
  result["displacement_modes"] = report.displacement.errors.size();
  result["displacement_error"] = report.displacement.pooled;
  result["displacement_error_worst"] = report.displacement.worst;
  result["stress_modes"] = report.stress.errors.size();
  result["stress_error"] = report.stress.pooled;
  result["stress_error_worst"] = report.stress.worst;
  if (options.json) {
    fmt::print("{}\n", result.dump(2));
    return;
  }
  for (const auto& [key, value] : result.items()) fmt::print("{:<26} {}\n", key, value.dump());
}

}  // namespace

void add_bench_bake(Command bench) {
  const auto options = std::make_shared<BenchBakeOptions>();
  Command command =
      bench.add_subcommand("bake", "Bake a body from nothing and say how long each stage took");
  command.add_option("body", options->description, "What to bake")
      .type_name("BODY.toml")
      .show_default();
  command.add_option("--threads", options->threads, "Sites solved side by side; 0: one per core")
      .in_range(0, 4096)
      .show_default();
  command.add_flag("--json", options->json, "One JSON object on stdout");
  command.footer("Example: palpable-bake bench bake bodies/bunny-demo.toml --json");
  command.callback([options] { bench_bake(*options); });
}

}  // namespace palpable::app
