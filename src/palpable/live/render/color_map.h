/// @file
/// The colour scales of fields painted on bodies, for pictures drawn on the CPU (legend). The
/// source is compiled as C++ and as a shader: shaders/color_map.glsl.
#pragma once

#include "palpable/common/geometry/image.h"

namespace palpable {

/// The colour scales for fields with one sign. In all but kRainbow a larger value is always
/// lighter. The shader gets the number of the enumerator: keep the order of color_map.glsl.
enum class ColorScale {
  kBlueYellow,  ///< steel blue, rose, yellow
  kViridis,     ///< violet, green, yellow (matplotlib's)
  kRainbow,     ///< blue, cyan, green, yellow, red, as finite-element programs paint
  kGray         ///< for print
};

/// The colour at a share of the scale, 0 (lowest) .. 1 (highest); clamped.
[[nodiscard]] Rgb color_of_share(float share, ColorScale scale = ColorScale::kBlueYellow);

/// With blending, the scale's colours cover the material completely above this share of the scale.
inline constexpr float kOpaqueShare = 0.2f;
/// A value of `opaque` at which the scale's colours never cover the material.
inline constexpr float kNothingPainted = 1e9f;

/// The same, blended with a material's colour, which is visible at low shares.
/// @param opaque  kOpaqueShare, or 0: no blending
[[nodiscard]] Rgb color_of_share(float share, Rgb material, float opaque,
                                 ColorScale scale = ColorScale::kBlueYellow);

/// The colour for a field of two signs, -1 .. 1; clamped. Its luminance strictly decreases from 0
/// to both ends.
[[nodiscard]] Rgb two_sided_color_of_share(float share);
/// The same, blended with a material's colour, which is visible near 0. @param opaque  as above
[[nodiscard]] Rgb two_sided_color_of_share(float share, Rgb material, float opaque);

}  // namespace palpable
