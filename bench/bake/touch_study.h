/// @file
/// What the bench of touch asks beyond how far an answer is from the full one
/// (touch_bake/touch_difference.h).
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/touch_solver.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// What the table of the compliance leaves out, relative L2 over the skin: for smooth loads of 8 mm
/// radius along the normal at `count` random vertices that are not held.
[[nodiscard]] std::vector<double> compliance_errors(const SkinResponse& skin,
                                                    const Compliance& compliance, int count,
                                                    std::uint64_t seed);

/// The largest jump of a vertex from frame to frame, m, while a finger that is 4 mm deep slides
/// over the skin by 0.5 mm a frame.
[[nodiscard]] double largest_slide_jump(const SkinResponse& skin, TouchSolver& touch,
                                        std::uint64_t seed);

}  // namespace palpable
