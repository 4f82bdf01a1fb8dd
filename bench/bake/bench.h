/// @file
/// The benchmarks of the offline half, one file each, named after the benchmark.
#pragma once

#include "palpable/common/base/json.h"

#include <chrono>

namespace palpable::app {

class Command;

/// s of wall time.
[[nodiscard]] double seconds_since(std::chrono::steady_clock::time_point begin);

/// Prints the results with the machine and the date, as one JSON object or as one line for each.
void print_figures(Json figures, bool json);

void add_bench_beam(Command bench);
void add_bench_bodies(Command bench);
void add_bench_campaign(Command bench);
void add_bench_clip(Command bench);
void add_bench_dynamics(Command bench);
void add_bench_elements(Command bench);
void add_bench_friction(Command bench);
void add_bench_obstacle(Command bench);
void add_bench_reduce(Command bench);
void add_bench_solid(Command bench);
void add_bench_touch(Command bench);

}  // namespace palpable::app
