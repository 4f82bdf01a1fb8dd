/// @file
/// 8-bit PNG files: the masks of a result (visible/, moving/) and the labels of a truth.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <optional>

namespace palpable {

/// Writes an image of visible/ or moving/. @throws Error when the file cannot be written
void write_mask(const std::filesystem::path& path, const MaskImage& mask);

/// Reads a mask: values above 127 become 255, others 0, since a lossy tool may have changed them.
/// Nothing when there is no such file. @throws Error naming the file when it cannot be read
[[nodiscard]] std::optional<MaskImage> read_mask(const std::filesystem::path& path);

/// Writes an image of labels/, whose values are bits and stay unchanged. @throws Error when the
/// file cannot be written
void write_labels(const std::filesystem::path& path, const GrayImage& labels);

/// Nothing when there is no such file. @throws Error naming the file when it cannot be read
[[nodiscard]] std::optional<GrayImage> read_labels(const std::filesystem::path& path);

}  // namespace palpable
