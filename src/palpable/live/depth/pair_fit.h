/// @file
/// Do two images fit the calibration that rectified them? A calibration can be sound and still be
/// another camera's, or that of swapped eyes. Then hardly a pixel is matched, and without this
/// check nobody would know why.
#pragma once

#include "palpable/common/geometry/image.h"

#include <optional>
#include <string>

namespace palpable {

/// How a pair contradicts its calibration.
struct PairMisfit {
  /// The images are swapped: things lie further right in the right image than they would at
  /// infinity.
  bool swapped = false;
  double rows_px = 0;  ///< by how much the right image lies lower, px of the given images

  /// One line: what is wrong and what to do.
  [[nodiscard]] std::string message() const;
};

/// By how many px of the given images the right one lies lower, to a quarter of one or so: the mean
/// of the rows on which the places of misfit_of() are found again, if three in five of them agree
/// on it to a row. Nothing otherwise. Costs as much and allocates, too.
[[nodiscard]] std::optional<double> rows_between(const GrayImage& left, const GrayImage& right,
                                                 int infinity, int reach);

/// Follows some 60 textured places of the left image through rows up to kFarthestRow up and down
/// and disparities up to `reach` to both sides, by the sum of absolute differences of 9 x 9 px with
/// their means removed. It is a misfit if three in five of them agree on it and the row watch could
/// not correct it. Nothing when the rows fit, or when too few places are found again.
///
/// Costs some 50 ms and allocates: for a first frame that matches badly, not for every frame.
///
/// @param infinity  disparity at infinity, px of these images
/// @param reach     px, >= 1
/// @throws ContractViolation when the images differ in size
[[nodiscard]] std::optional<PairMisfit> misfit_of(const GrayImage& left, const GrayImage& right,
                                                  int infinity, int reach);
inline constexpr int kFarthestRow = 24;  // px

}  // namespace palpable
