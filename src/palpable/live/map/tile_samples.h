/// @file
/// Which pixels of a tile stand for its depth.
#pragma once

#include <array>

namespace palpable {

/// (x, y) in a tile of kTile pixels, its middle first, spread over it.
inline constexpr std::array<std::array<int, 2>, 5> kTileSamples{
    {{2, 2}, {1, 1}, {3, 3}, {0, 3}, {3, 0}}};

}  // namespace palpable
