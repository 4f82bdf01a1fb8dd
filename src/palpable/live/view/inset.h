/// @file
/// A picture within a picture.
#pragma once

#include "palpable/common/geometry/image.h"

namespace palpable {

/// Draws `inside`, four times smaller and with a border, into the upper right corner: the
/// window's panel is at the left.
void draw_inset(const ColorImage& inside, ColorImage& picture);

}  // namespace palpable
