/// @file
/// Limits of what presses in one frame, of whoever gives it: a hands file, a client, a caller of
/// the C interface. palpable.h and docs/hands.md state them.
#pragma once

#include <cstddef>

namespace palpable {

inline constexpr std::size_t kMostThings = 256;
inline constexpr std::size_t kMostThingCapsules = 4096;  ///< of all things together

inline constexpr double kFarthestThing = 1000;     ///< m, largest coordinate
inline constexpr double kLeastThingRadius = 1e-4;  ///< m
inline constexpr double kMostThingRadius = 100;    ///< m

}  // namespace palpable
