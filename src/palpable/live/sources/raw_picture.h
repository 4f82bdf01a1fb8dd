/// @file
/// A picture in a video device's own format, converted to colour or depth.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/yuyv.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace palpable {

/// Four letters as V4L2 writes them, the first in the lowest byte.
constexpr std::uint32_t four_letters(const char (&text)[5]) {
  std::uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = code << 8 | static_cast<unsigned char>(text[i]);
  return code;
}
[[nodiscard]] std::string letters_of(std::uint32_t code);

/// A picture in memory that belongs to the device.
struct RawPicture {
  std::uint32_t format = 0;
  int width = 0;   ///< px
  int height = 0;  ///< px
  std::size_t row_bytes = 0;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< bytes that the device filled
};

/// Whether a format can be converted: YUYV, UYVY, NV12, GREY, RGB3, BGR3 and MJPG (JPEG) to colour;
/// Z16 and Y16 to depth.
[[nodiscard]] bool is_color_format(std::uint32_t format);
[[nodiscard]] bool is_depth_format(std::uint32_t format);

/// Converts. YUV is BT.601 with luma in 16 .. 235; a gray picture gives gray colours.
/// @return empty, or why the bytes are no picture of this size: too few, a JPEG that is cut off
[[nodiscard]] std::string to_color(const RawPicture& raw, ColorImage& image);

/// Copies a picture in YUYV as it is. @return as above
[[nodiscard]] std::string to_yuyv(const RawPicture& raw, YuyvImage& image);

/// The same for depth: steps of `unit` m; 0 and 65535 become NaN.
[[nodiscard]] std::string to_depth(const RawPicture& raw, double unit, DepthImage& image);

}  // namespace palpable
