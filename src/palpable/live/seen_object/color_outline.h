/// @file
/// Where a thing that presses ends, by its colours. On a desk without texture the matcher gives the
/// desk beside a finger the finger's depth, up to 5 px wide and with confidence; a picture of it
/// ends where the finger does.
///
///        room | thing, by its depth         the outermost `band` px of what presses are asked:
///     . . . . | b b b b b i i i i           does a pixel look as the room beside it does (.),
///                                           and not as the thing behind the band (i)?
///
/// Of both sides mean and spread of the colours are taken over cells of 8 x 8 px, 3 x 3 cells
/// around the pixel. What a thing shows at its outline may be shaded: half to 1.2 times its colour
/// is its own, too, for skin in the shade is as brown as a desk. Where the two sides look alike, or
/// a side shows all sorts of colours, or a thing is too thin to have an inside, nothing is decided:
/// the outline stays the depth's.
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
  int band = 6;  ///< px of the depth by which a thing is too wide at most; 0: nothing is asked
  /// Grey levels: what one place's colours differ by at least, noise and shading.
  double least_spread = 6;
  /// Spreads: the means of the two sides are so far apart at least.
  double apart = 3;
  int fewest = 8;  ///< pixels of a side that say how it looks
};

/// Keeps its memory.
class ColorOutline {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit ColorOutline(const ColorOutlineSettings& settings = {});

  /// Gives to the room what looks as it does along the outlines of what presses. Beside outlines at
  /// which colours tell both sides apart the room becomes kShowsRoomByColor.
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
    // Of the 3 x 3 cells around it: whether colours tell the sides apart, their means, and the
    // inverse squares of their spreads.
    bool tells = false;
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
  std::vector<std::size_t> asked_;  // cells that were summed up
};

}  // namespace palpable
