/// @file
/// palpable bench surface: how true the seen surface is, its unseen side above all.
#pragma once

namespace palpable::app {

class Command;

void add_bench_surface(Command bench);

}  // namespace palpable::app
