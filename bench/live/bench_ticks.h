/// @file
/// palpable bench ticks: what is answered between frames, against the true hand at that moment.
#pragma once

namespace palpable::app {

class Command;

void add_bench_ticks(Command bench);

}  // namespace palpable::app
