/// @file
/// The range of the factor by which a body is made larger or smaller than it was baked.
#pragma once

namespace palpable {

/// Smaller and larger bodies leave the range in which lengths in single precision are exact enough.
inline constexpr double kLeastScale = 1e-3, kMostScale = 1e3;

/// False for NaN.
[[nodiscard]] constexpr bool is_scale(double factor) {
  return factor >= kLeastScale && factor <= kMostScale;
}

}  // namespace palpable
