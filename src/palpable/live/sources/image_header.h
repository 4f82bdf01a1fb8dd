/// @file
/// What is wrong with an image file according to its header, before it is decoded.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace palpable {

/// Largest image that is read, px: four times the largest camera picture.
inline constexpr std::uint64_t kMostImagePixels = 64u << 20;

/// Largest image file that is read, bytes: as many pixels of four channels of 16 bits.
inline constexpr std::uint64_t kLargestImageFile = 8 * kMostImagePixels;

/// Why a file is not decoded: "is no image", "is cut off", "is damaged", "says it has 60000 x 60000
/// pixels", ...; empty: nothing is wrong so far. Sizes are known from the headers of PNG, JPEG,
/// BMP, PBM, PGM, PPM and TIFF, the formats that are read.
/// @param bytes  the whole file, or its first bytes; the end is only judged of a whole file
/// @param size   of the file, bytes
[[nodiscard]] std::string why_no_image(std::string_view bytes, std::uint64_t size);

}  // namespace palpable
