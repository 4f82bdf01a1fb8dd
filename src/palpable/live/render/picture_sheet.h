/// @file
/// Several pictures as one.
#pragma once

#include "palpable/common/geometry/image.h"

#include <vector>

namespace palpable {

/// Pictures side by side, row by row, on white.
/// @param cells  at least one, all of one size
[[nodiscard]] ColorImage sheet_of(const std::vector<ColorImage>& cells, int columns);

}  // namespace palpable
