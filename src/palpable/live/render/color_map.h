/// @file
/// The colour scales of what is painted on bodies, for pictures drawn on the CPU (legend). It
/// compiles the same file as the shaders: shaders/color_map.glsl.
#pragma once

#include "palpable/common/geometry/image.h"

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

/// Of what has two signs: -1 (the scale's length below 0) .. 1; clamped. Luminance falls strictly
/// from 0 to both ends.
[[nodiscard]] Rgb two_sided_color_of_share(float share);
/// The same with a material below it, which shines through near 0. @param opaque  as above
[[nodiscard]] Rgb two_sided_color_of_share(float share, Rgb material, float opaque);

}  // namespace palpable
