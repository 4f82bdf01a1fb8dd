/// @file
/// Finds the outlines of pressers in the colour picture, to a fraction of a pixel.
///
/// The mask of pressers comes from a depth image of half the picture's size, whose matcher makes
/// things wider by a pixel or two. In the picture the outline is an edge of colour. It is searched
/// along the normal of the mask's border, in samples one pixel of the picture apart:
///
///       outside          inside
///     . . . . . m o o|o o o o        .  samples of the room      o  samples of the thing
///                    |               m  the sample that the outline crosses
///            the mask's border
///
/// For each possible m, both sides are fitted by straight lines: each channel of the colour over
/// the place. The outline is at the m with the least
///
///     (sum of squared residuals) / 2 s^2  +  (shift - expected)^2 / 2 spread^2
///
/// The residual of m is its distance from the colours between those that both lines predict there;
/// where it lies between them is the share of m that shows the thing. s is the colours' noise, that
/// of the best fit or least_noise. An outline counts as found where both lines differ enough at m.
/// A border pixel takes the median of the outlines that were found beside it, each corrected for
/// the border's own curvature; it is known where more than half of them were found.
///
/// Outlines move inwards by up to 3 px, but outwards by half a pixel at most: farther out there is
/// no depth of the thing.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/live/depth/seen_frame.h"

#include <array>
#include <cstdint>
#include <vector>

namespace palpable {

struct OutlineSearchSettings {
  /// px of the picture that are searched on each side of the border; inside = 0: nothing is
  /// searched.
  int inside = 9, outside = 5;
  /// px of the depth image: the shift that is expected beside measured pixels, negative: inwards. A
  /// matcher whose windows reach over outlines has things too wide. Beside pixels without depth
  /// none is expected.
  double expected = 0;
  double spread = 1.0;        ///< px of the depth image, standard deviation of the shift
  double least_noise = 4;     ///< grey levels, standard deviation of a colour beside the line
  double least_contrast = 3;  ///< of both sides at the outline, in standard deviations
};

/// Keeps its memory.
class OutlineSearch {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit OutlineSearch(const OutlineSearchSettings& settings = {});

  /// Moves the outlines of pressers to where the colours change: pixels beyond them go to the room,
  /// and the room beside an outline that was found becomes kShowsRoomByEdge.
  /// @param shows  of the depth's size (geometry/image.h); changed inside the box alone
  void find(const SeenFrame& seen, const PixelBox& box, MaskImage& shows);

  /// The share of each pixel that shows a presser: 1 inside, 0 outside, between them at outlines
  /// that were found; at most 1/2 where `shows` has no presser. Of the depth's size; undefined
  /// outside of the box of the last find().
  [[nodiscard]] const Image<float>& coverage() const { return coverage_; }

 private:
  using Color = std::array<float, 3>;
  // A pixel of a presser beside one that shows none.
  struct Border {
    std::int16_t x, y;
    float nx, ny;     // unit, outwards
    float expected;   // px of the depth image
    float shift = 0;  // px of the depth image by which the outline lies outside of the border
    bool is_found = false;
    float median = 0;  // of the shifts that were found beside it
    bool is_known = false;
  };

  void find_border(const SeenFrame& seen, const MaskImage& shows);
  struct Profile;
  [[nodiscard]] bool sample(const SeenFrame& seen, const MaskImage& shows, const Border& at,
                            Profile& profile) const;
  void search(const SeenFrame& seen, const MaskImage& shows, Border& at) const;
  void find_medians();
  [[nodiscard]] bool goes_on(const SeenFrame& seen, const MaskImage& shows, int x, int y, float nx,
                             float ny) const;
  void draw(const SeenFrame& seen, MaskImage& shows);

  OutlineSearchSettings settings_;
  PixelBox box_;
  int factor_ = 1;
  Image<float> coverage_;
  Image<std::int32_t> border_at_;  // index + 1 into border_; 0: none
  Image<float> nearest_;           // px^2 to the nearest border pixel while draw() runs
  MaskImage is_known_;             // not 0 where that one's outline is known
  std::vector<Border> border_;
  // Of the border beside a pixel: the shift as seen from there, and the square of the place along
  // it.
  std::vector<std::array<float, 2>> beside_;
  std::vector<float> shifts_;
};

}  // namespace palpable
