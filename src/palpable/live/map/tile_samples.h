/// @file
/// The pixels of a tile at which its depth is sampled.
#pragma once

#include <array>

namespace palpable {

/// (x, y) in a tile of kTile x kTile pixels, its middle first, the others spread over it.
inline constexpr std::array<std::array<int, 2>, 5> kTileSamples{
    {{2, 2}, {1, 1}, {3, 3}, {0, 3}, {3, 0}}};

}  // namespace palpable
