/// @file
/// A picture within a picture.
#pragma once

#include "palpable/geometry/image.h"

namespace palpable {

/// Draws `inside`, four times smaller and with a border, into the upper left corner.
void draw_inset(const ColorImage& inside, ColorImage& picture);

}  // namespace palpable
