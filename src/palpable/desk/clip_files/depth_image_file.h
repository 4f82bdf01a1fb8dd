/// @file
/// Depth as 16-bit PNG files: depth/ of truths and results, body_depth/ of results.
#pragma once

#include "palpable/common/geometry/depth_counts.h"
#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <optional>

namespace palpable {

inline constexpr double kDepthUnit = 0.00025;   ///< m per count of the depth/ that we write
inline constexpr double kBodyDepthUnit = 1e-4;  ///< m per count of body_depth/

/// Z / kDepthUnit, rounded in single precision; kNoDepth where the depth is unknown or beyond the
/// counts, kTooClose where `too_close` is set.
/// @param too_close  of the same size, or empty
[[nodiscard]] DepthCounts measured_counts(const DepthImage& depth, const MaskImage& too_close);

/// Z / kDepthUnit, rounded in double precision; kNoDepth as above. In rare pixels, where Z lies
/// halfway between two counts, it differs by 1 from measured_counts().
[[nodiscard]] DepthCounts true_counts(const DepthImage& depth);

/// The depth of the drawn body at half size: of each block of 2 x 2 pixels the mean of those that
/// are known if they are two or more, else kNoDepth.
[[nodiscard]] DepthCounts body_counts(const DepthImage& full_size);

/// depth/ of a result. @throws Error when the file cannot be written, as the others do
void write_measured_depth(const std::filesystem::path& path, const DepthImage& depth,
                          const MaskImage& too_close);
/// depth/ of a truth.
void write_true_depth(const std::filesystem::path& path, const DepthImage& depth);
/// body_depth/ of a result. @param full_size  twice as large as what is written
void write_body_depth(const std::filesystem::path& path, const DepthImage& full_size);

/// Nothing when there is no such file. @throws Error naming it when it cannot be read
[[nodiscard]] std::optional<DepthCounts> read_depth_counts(const std::filesystem::path& path);

/// Metres; NaN for kNoDepth. @param unit  m per count
[[nodiscard]] DepthImage depth_of(const DepthCounts& counts, double unit);

}  // namespace palpable
