/// @file
/// palpable bench depth: the stereo matcher beside OpenCV's, in time and in what it finds.
#pragma once

namespace CLI {
class App;
}

namespace palpable::app {

void add_bench_depth(CLI::App& bench);

}  // namespace palpable::app
