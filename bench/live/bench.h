/// @file
/// The benchmarks of the live half, one file each, named after the benchmark.
#pragma once

namespace palpable::app {

class Command;

void add_bench_answer(Command bench);
void add_bench_body(Command bench);  ///< evaluate
void add_bench_depth(Command bench);
void add_bench_haptics(Command bench);
void add_bench_live(Command bench);
void add_bench_render(Command bench);
void add_bench_sgbm(Command bench);
void add_bench_surface(Command bench);
void add_bench_ticks(Command bench);
void add_bench_track(Command bench);

}  // namespace palpable::app
