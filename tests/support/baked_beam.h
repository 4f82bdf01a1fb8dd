/// @file
/// The small beam after an intrusive bake for several loads.
#pragma once

#include "palpable/bake/intrusive/intrusive_bake.h"
#include "tests/support/beam_description.h"
#include "tests/support/scratch_folder.h"

namespace palpable::test {

/// Baked at the first call.
inline const IntrusiveBake& baked_beam() {
  static const IntrusiveBake one = [] {
    const ScratchFolder folder("study");
    return bake_intrusive(
        describe_small_beam(folder.path(),
                            "[intrusive]\npositions = \"TOP\"\nreactions = \"UNDER\"\n"
                            "force = \"2 N\"\nmodes = 24\nstress_modes = 60\n"),
        {.version = "test", .command_line = "none"});
  }();
  return one;
}

}  // namespace palpable::test
