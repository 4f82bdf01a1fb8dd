/// @file
/// 8-bit PNG files: the masks of results (visible/, moving/) and the labels of truths.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <optional>

namespace palpable {

/// visible/ and moving/. @throws Error when the file cannot be written
void write_mask(const std::filesystem::path& path, const MaskImage& mask);

/// 255 above 127 (a lossy tool may have been at work), else 0. Nothing when there is no such file.
/// @throws Error naming it when it cannot be read
[[nodiscard]] std::optional<MaskImage> read_mask(const std::filesystem::path& path);

/// labels/: bits, which stay as they are. @throws Error when the file cannot be written
void write_labels(const std::filesystem::path& path, const GrayImage& labels);

/// Nothing when there is no such file. @throws Error naming it when it cannot be read
[[nodiscard]] std::optional<GrayImage> read_labels(const std::filesystem::path& path);

}  // namespace palpable
