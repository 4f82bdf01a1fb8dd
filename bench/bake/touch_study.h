/// @file
/// Measurements of the touch benchmark beyond the difference from full-order solutions
/// (touch_bake/touch_difference.h).
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/touch_solver.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// Error of the compliance table, relative L2 over the skin, for smooth loads of 8 mm radius along
/// the normal at `count` random free vertices.
[[nodiscard]] std::vector<double> compliance_errors(const SkinResponse& skin,
                                                    const Compliance& compliance, int count,
                                                    std::uint64_t seed);

/// m, largest displacement of a vertex between two frames while a finger with a penetration of 4 mm
/// slides over the skin by 0.5 mm per frame.
[[nodiscard]] double largest_slide_jump(const SkinResponse& skin, TouchSolver& touch,
                                        std::uint64_t seed);

}  // namespace palpable
