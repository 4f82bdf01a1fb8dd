/// @file
/// palpable bench render: what a picture costs.
#pragma once

namespace palpable::app {

class Command;

void add_bench_render(Command bench);

}  // namespace palpable::app
