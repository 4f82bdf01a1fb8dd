// palpable-bench: times of the live half's stages in ms, median and 99th percentile. Users start it
// by `palpable bench`.

#include "apps/common/command_line.h"

#include "bench/live/bench.h"
#include <cstdlib>

namespace palpable::app {
namespace {

int run_benches(int argc, char** argv) {
  // Suppresses messages of image and video libraries about codecs.
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  ::setenv("OPENCV_LOG_LEVEL", "SILENT", 0);

  const BenchCall call(argc, argv);
  CommandLine bench("Time the stages of the live half, or of a bake.", call.name,
                    std::string("palpable-bench ") + PALPABLE_VERSION);
  bench.require_subcommand();
  bench.footer(
      "Also, in the program palpable-bake-bench, which palpable starts:\n"
      "  bench beam      the beam by intrusive PGD\n"
      "  bench bodies    bodies that press each other, against full finite elements\n"
      "  bench campaign  all sites and levels of a body, into an empty folder\n"
      "  bench solid     one equilibrium path against CalculiX\n"
      "  bench elements  how true 4-node and 10-node tetrahedra are\n"
      "  bench reduce    all reductions beside each other\n"
      "  bench obstacle  contact against Hertz and CalculiX, and its cost on a body\n"
      "  bench touch     touch anywhere by a body's tables, against full finite elements\n"
      "  bench clip      the same under the true hand of a filmed clip\n"
      "  bench friction  what friction, which touch leaves out, would change\n"
      "Example: palpable bench evaluate bunny.palpable --json");
  add_bench_answer(bench);
  add_bench_body(bench);
  add_bench_depth(bench);
  add_bench_haptics(bench);
  add_bench_sgbm(bench);
  add_bench_surface(bench);
  add_bench_ticks(bench);
  add_bench_track(bench);
  add_bench_live(bench);
  add_bench_render(bench);
  return bench.run(call.argc, call.argv);
}

}  // namespace
}  // namespace palpable::app

int main(int argc, char** argv) { return palpable::app::run_benches(argc, argv); }
