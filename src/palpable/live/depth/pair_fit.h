/// @file
/// Checks whether two images fit the calibration that rectified them. A calibration can be valid
/// and still belong to another camera or to swapped images. Then hardly a pixel is matched, and
/// without this check the user would not know the reason.
#pragma once

#include "palpable/common/geometry/image.h"

#include <optional>
#include <string>

namespace palpable {

/// The contradiction between a pair and its calibration.
struct PairMisfit {
  /// The images are swapped: objects appear further right in the right image than they would at
  /// infinity.
  bool swapped = false;
  double rows_px = 0;  ///< offset of the right image downwards, px of the given images

  /// One line: the fault, and how to correct it.
  [[nodiscard]] std::string message() const;
};

/// The vertical offset of the right image, px of the given images, positive where it is lower,
/// accurate to about 0.25 px. It is the mean over the points that misfit_of() finds again; nothing
/// unless 60 % of them agree to within one row. Has the same cost as misfit_of().
[[nodiscard]] std::optional<double> rows_between(const GrayImage& left, const GrayImage& right,
                                                 int infinity, int reach);

/// Searches about 60 textured points of the left image in the right one, over rows up to
/// kFarthestRow up and down and disparities up to `reach` to both sides of infinity, by the sum of
/// absolute differences of 9 x 9 px windows with their means removed. Returns a misfit if 60 % of
/// the points found agree on it and it is larger than the row watch can correct. Returns nothing if
/// the rows fit, or if too few points are found again.
///
/// Takes about 50 ms and allocates: for a first frame that matches badly, not for every frame.
///
/// @param infinity  disparity at infinity, px of these images
/// @param reach     px, >= 1
/// @throws ContractViolation if the images differ in size
[[nodiscard]] std::optional<PairMisfit> misfit_of(const GrayImage& left, const GrayImage& right,
                                                  int infinity, int reach);
inline constexpr int kFarthestRow = 24;  // px

}  // namespace palpable
