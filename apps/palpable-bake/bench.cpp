// palpable-bake bench: what the parts of the offline half cost, and how true they are.

#include "apps/palpable-bake/bench.h"

#include "apps/palpable-bake/commands.h"

#include <CLI/CLI.hpp>

namespace palpable::app {

void add_bench(CLI::App& app) {
  CLI::App* bench = app.add_subcommand("bench", "Time the parts of a bake");
  bench->require_subcommand(1);
  bench->footer("Example: palpable-bake bench bake --json");
  add_bench_bake(*bench);
  add_bench_beam(*bench);
  add_bench_campaign(*bench);
  add_bench_solid(*bench);
  add_bench_elements(*bench);
  add_bench_reduce(*bench);
}

}  // namespace palpable::app
