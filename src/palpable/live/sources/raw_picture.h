/// @file
/// A picture in a video device's own format, converted to colour or depth.
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace palpable {

/// A V4L2 format code from four letters, the first in the lowest byte.
constexpr std::uint32_t four_letters(const char (&text)[5]) {
  std::uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = code << 8 | static_cast<unsigned char>(text[i]);
  return code;
}
[[nodiscard]] std::string letters_of(std::uint32_t code);

/// A picture in memory of the device.
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

/// Converts a picture. YUV is BT.601 with luma in 16 .. 235; a grey picture gives grey colours.
/// @return empty, or why the bytes are not a picture of this size, e.g. too few or a truncated JPEG
[[nodiscard]] std::string to_color(const RawPicture& raw, ColorImage& image);

/// Copies a YUYV picture without conversion. @return why that failed; empty: it succeeded
[[nodiscard]] std::string to_yuyv(const RawPicture& raw, YuyvImage& image);

/// Converts a depth picture with steps of `unit` m; 0 and 65535 become NaN. @return as to_color()
[[nodiscard]] std::string to_depth(const RawPicture& raw, double unit, DepthImage& image);

}  // namespace palpable
