/// @file
/// palpable bench live: the whole loop as `palpable live` runs it, from raw pictures to the picture
/// and the files.
#pragma once

namespace palpable::app {

class Command;

void add_bench_live(Command bench);

}  // namespace palpable::app
