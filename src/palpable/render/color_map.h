/// @file
/// The colour scale of stress, for pictures drawn on the CPU (legend). It compiles the same file as
/// the shaders: shaders/color_map.glsl.
#pragma once

#include "palpable/geometry/image.h"

namespace palpable {

/// Colour of a place on the scale, 0 (lowest) .. 1 (highest); clamped. Luminance rises strictly
/// with it.
[[nodiscard]] Rgb color_of_share(float share);

/// From this share of the scale on its colours cover a body's own wholly, where they are blended.
inline constexpr float kOpaqueShare = 0.2f;
/// So large that nothing is painted.
inline constexpr float kNothingPainted = 1e9f;

/// The same with a material below it, which shines through where little is painted.
/// @param opaque  kOpaqueShare, or 0: the scale alone
[[nodiscard]] Rgb color_of_share(float share, Rgb material, float opaque);

}  // namespace palpable
