/// @file
/// A picture at half its size, for a page.
#pragma once

#include "palpable/common/geometry/image.h"

namespace palpable {

/// Each pixel is the rounded mean of four; a last odd row or column is left out.
/// @param picture  of at least 2 x 2
/// @param half     overwritten; its memory is reused
void halve(const ColorImage& picture, ColorImage& half);

}  // namespace palpable
