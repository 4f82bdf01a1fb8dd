/// @file
/// The benches of the offline half: one file each, named after the bench.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace CLI {
class App;
}

namespace palpable::app {

/// Prints what a bench found, and on which machine and when: one JSON object, or a line for each.
void print_figures(nlohmann::ordered_json figures, bool json);

void add_bench_bake(CLI::App& bench);
void add_bench_beam(CLI::App& bench);
void add_bench_campaign(CLI::App& bench);
void add_bench_elements(CLI::App& bench);
void add_bench_reduce(CLI::App& bench);
void add_bench_solid(CLI::App& bench);

}  // namespace palpable::app
