/// @file
/// palpable bench depth: the stereo matcher beside OpenCV's, in time and in what it finds.
#pragma once

namespace palpable::app {

class Command;

void add_bench_depth(Command bench);

}  // namespace palpable::app
