/// @file
/// Comparison of a mask, such as that of moving things, with the true one.
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstdint>
#include <optional>

namespace palpable {

/// Pixel counts of one frame or the sum over many frames.
struct MaskScore {
  std::int64_t truth = 0;   ///< set in the truth
  std::int64_t found = 0;   ///< set in the result
  std::int64_t both = 0;    ///< set in both
  std::int64_t pixels = 0;  ///< compared pixels: those of frames with a mask

  MaskScore& operator+=(const MaskScore& other);

  /// Intersection over union. Nothing when the truth is empty, because it would then be 0 for a
  /// single wrong pixel as for a million.
  [[nodiscard]] std::optional<double> iou() const;
  /// Share of the true pixels that were found; nothing when there are none.
  [[nodiscard]] std::optional<double> recall() const;
  /// Share of the compared pixels that are set in the result only; nothing when none were compared.
  [[nodiscard]] std::optional<double> false_alarms() const;
};

/// Compares one frame.
/// @param truth  bit `bit` of each pixel is the true mask
/// @param found  not 0 where the result sets the mask; the same size
/// @throws ContractViolation when the sizes differ
[[nodiscard]] MaskScore compare_masks(const GrayImage& truth, std::uint8_t bit,
                                      const MaskImage& found);

/// A frame without a mask: its true pixels count as missed, and none of its pixels as compared.
[[nodiscard]] MaskScore missing_mask(const GrayImage& truth, std::uint8_t bit);

}  // namespace palpable
