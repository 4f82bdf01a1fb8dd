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
  std::size_t size = 0;       ///< bytes that the device filled
  bool by_realsense = false;  ///< the maker's own order of the bits in Y12I: to_eyes()
};

/// Whether a format can be converted: YUYV, UYVY, NV12, GREY, RGB3, BGR3 and MJPG (JPEG) to colour;
/// Z16 to depth; Y8I and Y12I, grey pictures whose pixels alternate between the eyes, to two.
[[nodiscard]] bool is_color_format(std::uint32_t format);
[[nodiscard]] bool is_depth_format(std::uint32_t format);
[[nodiscard]] bool is_interleaved_format(std::uint32_t format);
/// Y16: numbers of 16 bits that mean anything: infrared (RealSense), a maker's codes (Orbbec), or
/// depth. They are converted to depth only where the user says that they are.
[[nodiscard]] bool is_gray16_format(std::uint32_t format);

/// Converts a picture. YUV is BT.601 with luma in 16 .. 235; a grey picture gives grey colours.
/// @return empty, or why the bytes are not a picture of this size, e.g. too few or a truncated JPEG
[[nodiscard]] std::string to_color(const RawPicture& raw, ColorImage& image);

/// Separates a picture in Y8I or Y12I, whose width is that of one eye. The grey values of Y12I are
/// scaled to 8 bits.
///
///     Y8I    2 bytes a pixel: left, right
///     Y12I   24 bits a pixel, low byte first: left in the low 12 bits, right in the high ones
///            (kernel documentation, pixfmt-y12i)
///     Y12I of a RealSense: right in the low ones, left in the high ones, and only values up to
///            1023 (librealsense, y12i-to-y16y16.cpp)
///
/// @return as to_color()
[[nodiscard]] std::string to_eyes(const RawPicture& raw, ColorImage& left, ColorImage& right);

/// Copies a YUYV picture without conversion. @return why that failed; empty: it succeeded
[[nodiscard]] std::string to_yuyv(const RawPicture& raw, YuyvImage& image);

/// Converts a depth picture with steps of `unit` m; 0 and 65535 become NaN. @return as to_color()
[[nodiscard]] std::string to_depth(const RawPicture& raw, double unit, DepthImage& image);

}  // namespace palpable
