/// @file
/// palpable bench sgbm-reference: is the synthetic desk as hard as it claims to be?
#pragma once

namespace palpable::app {

class Command;

void add_bench_sgbm(Command bench);

}  // namespace palpable::app
