/// @file
/// A mask against the true one: what moves.
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstdint>
#include <optional>

namespace palpable {

/// Pixels of one frame or, added up, of many.
struct MaskScore {
  std::int64_t truth = 0;   ///< set in the truth
  std::int64_t found = 0;   ///< set in the result
  std::int64_t both = 0;    ///< set in both
  std::int64_t pixels = 0;  ///< compared: of the frames that have a mask

  MaskScore& operator+=(const MaskScore& other);

  /// Intersection over union; nothing when nothing is set in the truth: then it would be 0 for one
  /// wrong pixel as for a million.
  [[nodiscard]] std::optional<double> iou() const;
  /// Share of the true pixels that were found; nothing when there are none.
  [[nodiscard]] std::optional<double> recall() const;
  /// Share of the compared pixels that are found and not true; nothing when none were compared.
  [[nodiscard]] std::optional<double> false_alarms() const;
};

/// Compares one frame.
/// @param truth  bit `bit` of each pixel is the true mask
/// @param found  not 0 where the result says so; the same size
/// @throws ContractViolation for other sizes
[[nodiscard]] MaskScore compare_masks(const GrayImage& truth, std::uint8_t bit,
                                      const MaskImage& found);

/// A frame without a mask: its true pixels count as missed, none of its pixels counts as compared.
[[nodiscard]] MaskScore missing_mask(const GrayImage& truth, std::uint8_t bit);

}  // namespace palpable
