/// @file
/// Finds the outlines of pressers in the colour picture, to a fraction of a pixel.
///
/// The mask of pressers comes from a depth image of half the picture's size, whose matcher makes
/// things wider by a pixel or two. In the picture the outline is an edge of colour. It is searched
/// along the normal of the mask's border:
///
///            outside     │ inside           samples of the colour picture, 1 px of it apart
///     . . . . . . . . m o o o o o o o o     m: the sample that the outline crosses
///             the room <─┤                  both sides: a straight line through the colours of
///             each
///                        the mask's border  channel
///
/// For each possible place of m, both sides are fitted by straight lines (colour over place); the
/// place with the least
///
///     (sum of squared residuals of both sides) / 2 s^2  +  (shift - expected)^2 / 2 spread^2
///
/// is the outline's, with s the colours' noise. The share of m that shows the thing follows from
/// its colour, between those that both lines predict there. An outline is known where the lines
/// differ there by enough; the shift of a pixel's outline is the median over the border beside it.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/live/depth/seen_frame.h"

#include <array>
#include <cstdint>
#include <vector>

namespace palpable {

struct OutlineSearchSettings {
  int inside = 9, outside = 5;  ///< px of the picture that are searched on each side of the border
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
  /// that were found. Of the depth's size; valid inside the box of the last find().
  [[nodiscard]] const Image<float>& coverage() const { return coverage_; }

 private:
  using Color = std::array<float, 3>;
  // A pixel of a presser beside one that shows none.
  struct Border {
    std::int16_t x, y;
    float nx, ny;      // unit, outwards
    float expected;    // px of the depth image
    float shift = 0;   // px of the depth image by which the outline lies outside of the border
    float weight = 0;  // 0: the outline was not found
    float smooth = 0;  // the median of the shifts beside it
    bool is_known = false;
  };

  void find_border(const SeenFrame& seen, const MaskImage& shows);
  void search(const SeenFrame& seen, const MaskImage& shows, Border& at) const;
  void smooth();
  void draw(const SeenFrame& seen, MaskImage& shows);

  OutlineSearchSettings settings_;
  PixelBox box_;
  int factor_ = 1;
  Image<float> coverage_;
  Image<std::int32_t> border_at_;  // index + 1 into border_; 0: none
  Image<float> nearest_;           // px^2 to the nearest border pixel while draw() runs
  std::vector<Border> border_;
  // Of the border beside a pixel: the shift as seen from there, and the square of the place along
  // it.
  std::vector<std::array<float, 2>> beside_;
  std::vector<float> shifts_;
};

}  // namespace palpable
