/// @file
/// The benches of the offline half: one file each, named after the bench.
#pragma once

namespace CLI {
class App;
}

namespace palpable::app {

void add_bench_bake(CLI::App& bench);
void add_bench_beam(CLI::App& bench);
void add_bench_campaign(CLI::App& bench);
void add_bench_elements(CLI::App& bench);
void add_bench_reduce(CLI::App& bench);
void add_bench_solid(CLI::App& bench);

}  // namespace palpable::app
