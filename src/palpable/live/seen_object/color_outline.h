/// @file
/// Corrects the outline of a presser by its colours. On a desk without texture the matcher gives
/// the desk beside a finger the finger's depth, up to 5 px wide and with confidence; in the colour
/// picture the finger ends where it really does.
///
///        room | thing, by its depth         the outermost `band` px of a thing (b) are tested: a
///     . . . . | b b b b b i i i i           pixel goes to the room if its colour is like that of
///                                           the room (.), and not like that of the inside (i)
///
/// Mean and variance of the colours of both sides are taken over the 3 x 3 cells of 8 x 8 px around
/// the pixel. A thing may be shaded at its outline: 0.5 to 1.2 times its colour counts as its own,
/// too, because skin in the shade can be as brown as a desk. The outline of the depth is kept where
/// the two sides have similar colours, where a side has many different colours, and where a thing
/// is too thin to have an inside.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/live/depth/seen_frame.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

struct ColorOutlineSettings {
  /// px of the depth image: the width of the band that is tested, the largest width by which a
  /// matcher makes things too wide. 0: nothing is corrected.
  int band = 6;
  /// Grey levels: the standard deviation that every side is taken to have at least, by noise and
  /// shading.
  double least_spread = 6;
  /// The sides differ enough when their means are farther apart than this, in standard deviations.
  double apart = 3;
  int fewest = 8;  ///< samples of a side that are needed to know its colours
};

/// Corrects the outlines of pressers in a mask. Keeps its memory.
class ColorOutline {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit ColorOutline(const ColorOutlineSettings& settings = {});

  /// Gives pixels along the outlines of pressers to the room if they have the room's colour. Where
  /// the two sides differ enough in colour, the room beside the outline becomes kShowsRoomByColor.
  /// @param shows  of the depth's size (geometry/image.h); changed inside the box alone
  void trim(const SeenFrame& seen, const PixelBox& box, MaskImage& shows);

 private:
  using Color = std::array<float, 3>;
  // Sums over the pixels of one side in a cell.
  struct Side {
    float count = 0;
    Color sum{}, square{};
    void add(const Side& other);
  };
  struct Cell {
    bool is_summed = false, is_compared = false;
    Side thing, room;
    // Over the 3 x 3 cells around it: whether the sides differ enough, their means, and the inverse
    // variances.
    bool differs = false;
    Color thing_mean{}, room_mean{}, thing_weight{}, room_weight{};
  };
  struct Place {
    std::int16_t x, y;
  };

  [[nodiscard]] Color color_at(const SeenFrame& seen, int x, int y) const;
  void find_band(const PixelBox& box, const MaskImage& shows);
  const Cell& summed(const SeenFrame& seen, const MaskImage& shows, int i, int j);
  const Cell& compared(const SeenFrame& seen, const MaskImage& shows, int i, int j);
  void mark_known(const SeenFrame& seen, const PixelBox& box, MaskImage& shows);
  [[nodiscard]] bool is_room(const SeenFrame& seen, const MaskImage& shows, int x, int y);
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(across_) +
           static_cast<std::size_t>(i);
  }

  ColorOutlineSettings settings_;
  PixelBox box_;
  int factor_ = 1;             // the colour image's size over the depth's
  int across_ = 0, down_ = 0;  // cells of the image
  GrayImage in_band_;          // not 0: the pixel lies in the band; all 0 between two calls
  std::vector<Place> band_;    // from the outline inwards
  std::vector<Cell> cells_;
  std::vector<std::size_t> summed_;  // cells whose sums are valid
};

}  // namespace palpable
