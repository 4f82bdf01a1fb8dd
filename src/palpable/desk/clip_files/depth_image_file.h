/// @file
/// Depth as 16-bit PNG files: depth/ of a truth and of a result, body_depth/ of a result.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <optional>

namespace palpable {

inline constexpr double kDepthUnit = 0.00025;   ///< m per count of depth/
inline constexpr double kBodyDepthUnit = 1e-4;  ///< m per count of body_depth/

/// Z / kDepthUnit, rounded in single precision; kNoDepth where the depth is unknown or does
/// not fit in a count, kTooClose where `too_close` is set.
/// @param too_close  of the same size, or empty
[[nodiscard]] DepthCounts measured_counts(const DepthImage& depth, const MaskImage& too_close);

/// Z / kDepthUnit, rounded in double precision; kNoDepth as above. It differs by 1 from
/// measured_counts() in the rare pixels where Z lies halfway between two counts.
[[nodiscard]] DepthCounts true_counts(const DepthImage& depth);

/// The depth of the drawn body at half size: the mean of the known pixels of each block of 2 x 2,
/// or kNoDepth where fewer than two of them are known.
[[nodiscard]] DepthCounts body_counts(const DepthImage& full_size);

/// Writes an image of depth/ of a result. @throws Error when the file cannot be written, as the
/// other writers do
void write_measured_depth(const std::filesystem::path& path, const DepthImage& depth,
                          const MaskImage& too_close);
/// Writes an image of depth/ of a truth.
void write_true_depth(const std::filesystem::path& path, const DepthImage& depth);
/// Writes an image of body_depth/ of a result. @param full_size  twice as wide and high as the file
void write_body_depth(const std::filesystem::path& path, const DepthImage& full_size);

/// Nothing when there is no such file. @throws Error naming the file when it cannot be read
[[nodiscard]] std::optional<DepthCounts> read_depth_counts(const std::filesystem::path& path);

/// Depth in m; NaN for kNoDepth. @param unit  m per count
[[nodiscard]] DepthImage depth_of(const DepthCounts& counts, double unit);

}  // namespace palpable
