/// @file
/// Error of a body that was baked for several loads at once, against full-order solutions.
#pragma once

#include "palpable/bake/intrusive/intrusive_bake.h"
#include "palpable/common/base/progress.h"

#include <vector>

namespace palpable {

/// Solves `count` random pairs of loads with the full-order solver and with the reduced model, and
/// compares them. A pair is a press of 0.05 .. 1 times the full load at a random
/// position, and a reaction of 0 .. 1 times that press at a random reaction site. The reduced
/// solution is that of the live half (LoadedBody), on the modes of all nodes.
/// @pre made.body.several
[[nodiscard]] std::vector<TwoLoadCheck> two_load_checks(const IntrusiveBake& made, int count,
                                                        unsigned seed,
                                                        const Progress& progress = {});

}  // namespace palpable
