/// @file
/// palpable bench track: what following the camera costs, and how true it is on recordings with
/// truth.
#pragma once

namespace CLI {
class App;
}

namespace palpable::app {

void add_bench_track(CLI::App& bench);

}  // namespace palpable::app
