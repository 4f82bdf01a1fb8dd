/// @file
/// Images in the format in which many cameras send them: luma for each pixel, colour for each two.
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstdint>

namespace palpable {

/// Two neighbouring pixels, YUYV in memory. BT.601: luma 16 .. 235; U, V about 128.
struct Yuyv {
  std::uint8_t y0 = 16;
  std::uint8_t u = 128;
  std::uint8_t y1 = 16;
  std::uint8_t v = 128;
  friend bool operator==(const Yuyv&, const Yuyv&) = default;
};
static_assert(sizeof(Yuyv) == 4, "as it lies in a camera's memory");

using YuyvImage = Image<Yuyv>;  ///< half as wide as the picture

}  // namespace palpable
