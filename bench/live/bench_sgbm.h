/// @file
/// palpable bench sgbm-reference: is the synthetic desk as hard as it claims to be?
#pragma once

namespace CLI {
class App;
}

namespace palpable::app {

void add_bench_sgbm(CLI::App& bench);

}  // namespace palpable::app
