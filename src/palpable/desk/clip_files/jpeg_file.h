/// @file
/// The pictures of clips, frames/left and frames/right: JPEG of quality 96.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>

namespace palpable {

/// @throws Error when the file cannot be written
void write_jpeg(const std::filesystem::path& path, const ColorImage& picture);

/// The picture after encoding and decoding as write_jpeg() and a reader of its file would do it,
/// without a file.
[[nodiscard]] ColorImage through_jpeg(const ColorImage& picture);

}  // namespace palpable
