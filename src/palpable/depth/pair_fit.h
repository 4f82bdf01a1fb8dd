/// @file
/// Do two images fit the calibration that rectified them? Numbers can be sound and still belong to
/// another camera, another resolution, or to the eyes the other way round; then hardly a pixel
/// finds its partner, and nothing says why.
#pragma once

#include "palpable/geometry/image.h"

#include <optional>
#include <string>

namespace palpable {

/// What a pair shows that a calibration that fits would not.
struct PairMisfit {
  /// Things lie further right in the right image than at infinity: the images are swapped.
  bool swapped = false;
  double rows_px = 0;  ///< by how much the right image lies lower, px of the images that were given

  /// One line: what is wrong and what to do.
  [[nodiscard]] std::string message() const;
};

/// Follows some 60 textured places of the left image through rows up to kFarthestRow up and down
/// and disparities up to `reach` to both sides, by the sum of absolute differences of 9 x 9 px with
/// their means removed. A misfit is what three in five of them agree on, and more than the row
/// watch can correct. Nothing when the rows fit, and when too few places say anything.
///
/// Takes some 50 ms and memory: for a first frame that matches badly, not for the loop.
///
/// @param infinity  disparity at infinity, px of these images
/// @param reach     px, >= 1
/// @throws ContractViolation when the images differ in size
[[nodiscard]] std::optional<PairMisfit> misfit_of(const GrayImage& left, const GrayImage& right,
                                                  int infinity, int reach);
inline constexpr int kFarthestRow = 24;  // px

}  // namespace palpable
