/// @file
/// Pictures as PNG files, read and written with libpng.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/image.h"

#include <filesystem>

namespace palpable {

/// Writes an 8-bit sRGB PNG. The folder must exist.
/// @throws Error when the file cannot be written, with the reason
void write_png(const std::filesystem::path& path, const ColorImage& picture);
/// Writes a mask or grey image as 8-bit grey PNG, likewise.
void write_png(const std::filesystem::path& path, const GrayImage& picture);

/// Reads any PNG as 8-bit RGB: grey is repeated in all channels, transparency is dropped. The
/// problem names the file and what is wrong with it. Images of more than 2^27 pixels are refused.
[[nodiscard]] Result<ColorImage> read_png(const std::filesystem::path& path);

}  // namespace palpable
