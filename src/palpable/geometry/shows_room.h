/// @file
/// How the room is known beside a thing that presses (kShowsRoom of image.h).
#pragma once

#include "palpable/geometry/image.h"

#include <cstdint>

namespace palpable {

/// The room beside a thing's outline that colours tell, and not only depth (map/color_outline.h).
inline constexpr std::uint8_t kShowsRoomByColor = 1;

[[nodiscard]] constexpr bool shows_room(std::uint8_t shows) {
  return shows == kShowsRoom || shows == kShowsRoomByColor;
}

}  // namespace palpable
