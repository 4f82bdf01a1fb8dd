/// @file
/// The colours of stress, for what is drawn on the CPU (legend). The same text as the shader's:
/// shaders/color_map.glsl.
#pragma once

#include "palpable/geometry/image.h"

namespace palpable {

/// Colour of a share of the scale; clamped to 0..1. Luminance rises strictly with the share.
[[nodiscard]] Rgb color_of_share(float share);

}  // namespace palpable
