/// @file
/// Blends a colour into a pixel.
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstdint>

namespace palpable {

/// Blends a colour into a pixel. @param share  0 leaves the pixel unchanged, 1 replaces it
inline void mix_color(Rgb& pixel, Rgb color, float share) {
  const auto one = [share](std::uint8_t from, std::uint8_t to) {
    const float value =
        static_cast<float>(from) + share * (static_cast<float>(to) - static_cast<float>(from));
    return static_cast<std::uint8_t>(value + 0.5f);
  };
  pixel = {one(pixel.r, color.r), one(pixel.g, color.g), one(pixel.b, color.b)};
}

}  // namespace palpable
