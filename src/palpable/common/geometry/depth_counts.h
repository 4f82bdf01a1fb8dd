/// @file
/// Depth images in the integer units of their files.
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstdint>

namespace palpable {

/// Z = count * unit; the unit, in metres, goes with the folder (docs/benchmark.md).
using DepthCounts = Image<std::uint16_t>;

inline constexpr std::uint16_t kNoDepth = 0;
/// In measured images: the pixel shows something that is too near to be measured. In images of a
/// truth this is an ordinary count.
inline constexpr std::uint16_t kTooClose = 65535;

}  // namespace palpable
