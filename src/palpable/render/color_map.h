/// @file
/// The colour scale of stress, for pictures drawn on the CPU (legend). It compiles the same file as
/// the shaders: shaders/color_map.glsl.
#pragma once

#include "palpable/geometry/image.h"

namespace palpable {

/// Colour of a place on the scale, 0 (lowest) .. 1 (highest); clamped. Luminance rises strictly
/// with it.
[[nodiscard]] Rgb color_of_share(float share);

}  // namespace palpable
