/// @file
/// palpable bench track: what following the camera costs, and how true it is on recordings with
/// truth.
#pragma once

namespace palpable::app {

class Command;

void add_bench_track(Command bench);

}  // namespace palpable::app
