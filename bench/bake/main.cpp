// palpable-bake-bench: cost and accuracy of the parts of the offline half. Users start it by
// `palpable bench`.

#include "apps/common/command_line.h"
#include "apps/palpable-bake/processor_kernels.h"

#include "bench/bake/bench.h"

namespace palpable::app {
namespace {

int run_benches(int argc, char** argv) {
  const BenchCall call(argc, argv);
  CommandLine bench("Time the parts of a bake, and compare them with what is known without it.",
                    call.name, std::string("palpable-bake-bench ") + PALPABLE_VERSION);
  bench.require_subcommand();
  bench.footer("Example: palpable bench campaign --json");
  add_bench_beam(bench);
  add_bench_bodies(bench);
  add_bench_campaign(bench);
  add_bench_clip(bench);
  add_bench_solid(bench);
  add_bench_dynamics(bench);
  add_bench_elements(bench);
  add_bench_friction(bench);
  add_bench_obstacle(bench);
  add_bench_reduce(bench);
  add_bench_touch(bench);
  return bench.run(call.argc, call.argv);
}

}  // namespace
}  // namespace palpable::app

int main(int argc, char** argv) {
  palpable::app::use_kernels_of_this_processor(argv);
  return palpable::app::run_benches(argc, argv);
}
