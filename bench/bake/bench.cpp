// palpable-bake bench: what the parts of the offline half cost, and how true they are.

#include "bench/bake/bench.h"

#include "apps/common/command_line.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/base/json.h"
#include "palpable/base/this_machine.h"

#include <fmt/core.h>

#include <thread>

namespace palpable::app {

void print_figures(Json figures, bool json) {
  figures["peak_memory_mb"] = peak_memory() / 1e6;
  figures["cores"] = std::thread::hardware_concurrency();
  figures["processor"] = processor_name();
  figures["date"] = date_today();
  if (json) {
    fmt::print("{}\n", figures.dump(2));
    return;
  }
  for (const auto& [key, value] : figures.items()) fmt::print("{:<36} {}\n", key, value.dump());
}

void add_bench(Command app) {
  Command bench = app.add_subcommand("bench", "Time the parts of a bake");
  bench.require_subcommand();
  bench.footer("Example: palpable bench bake --json");
  add_bench_bake(bench);
  add_bench_beam(bench);
  add_bench_bodies(bench);
  add_bench_campaign(bench);
  add_bench_clip(bench);
  add_bench_solid(bench);
  add_bench_elements(bench);
  add_bench_friction(bench);
  add_bench_obstacle(bench);
  add_bench_reduce(bench);
  add_bench_touch(bench);
}

}  // namespace palpable::app
