/// @file
/// Depth as the whole numbers that its files hold.
#pragma once

#include "palpable/geometry/image.h"

#include <cstdint>

namespace palpable {

/// Z = count * unit; the unit, in metres, goes with the folder (docs/benchmark.md).
using DepthCounts = Image<std::uint16_t>;

inline constexpr std::uint16_t kNoDepth = 0;
/// Something is there, nearer than can be measured. In a measured image only; in a truth this is an
/// ordinary count.
inline constexpr std::uint16_t kTooClose = 65535;

}  // namespace palpable
