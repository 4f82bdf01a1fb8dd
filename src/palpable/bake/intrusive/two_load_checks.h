/// @file
/// How far a body that was baked for several loads at once is from states solved afresh.
#pragma once

#include "palpable/bake/intrusive/intrusive_bake.h"
#include "palpable/common/base/progress.h"

#include <vector>

namespace palpable {

/// A press of 0.05 .. 1 of the full load at any position, and 0 .. 1 of that pushing back.
/// Solved as the live half does (LoadedBody), on the modes of all nodes.
/// @pre made.body.several
[[nodiscard]] std::vector<TwoLoadCheck> two_load_checks(const IntrusiveBake& made, int count,
                                                        unsigned seed,
                                                        const Progress& progress = {});

}  // namespace palpable
