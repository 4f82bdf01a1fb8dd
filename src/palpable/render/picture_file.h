/// @file
/// Pictures as PNG files, read and written with libpng.
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/image.h"

#include <cstdint>
#include <filesystem>

namespace palpable {

/// Writes an 8-bit sRGB PNG. The folder must exist.
/// @throws Error when the file cannot be written, with the reason
void write_png(const std::filesystem::path& path, const ColorImage& picture);
/// Writes a mask or grey image as 8-bit grey PNG, likewise.
void write_png(const std::filesystem::path& path, const GrayImage& picture);

/// Writes a depth image as 16-bit grey PNG: round(Z / unit), 0 where unknown or beyond the range.
/// @param unit  m per count, e.g. 1e-4
/// @throws Error when the file cannot be written
void write_depth_png(const std::filesystem::path& path, const DepthImage& depth, double unit);

/// Reads any PNG as 8-bit RGB: grey is repeated in all channels, transparency is dropped. The
/// problem names the file and what is wrong with it. Images of more than 2^27 pixels are refused.
[[nodiscard]] Result<ColorImage> read_png(const std::filesystem::path& path);

/// Reads a 16-bit grey PNG as depth in m: Z = count * unit, and NaN for count 0. The problem names
/// the file.
[[nodiscard]] Result<DepthImage> read_depth_png(const std::filesystem::path& path, double unit);

}  // namespace palpable
