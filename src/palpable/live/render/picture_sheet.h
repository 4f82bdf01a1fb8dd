/// @file
/// Combines several pictures into one.
#pragma once

#include "palpable/common/geometry/image.h"

#include <vector>

namespace palpable {

/// Puts pictures side by side, row by row, on a white sheet.
/// @param cells  at least one, all of one size
[[nodiscard]] ColorImage sheet_of(const std::vector<ColorImage>& cells, int columns);

}  // namespace palpable
