/// @file
/// From tiles that move to pixels that move. Whole tiles would leave a rim of the scene around a
/// hand and of the hand beside it; here the mask follows the border that depth and look show.
///
///   tile  a square of 4 x 4 pixels of the depth image (static_picture.h)
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/map/static_picture.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// Draws the mask of one frame after the other.
///
///     . . . . . .      . all nine tiles around it rest: drawn whole, 0
///     . b b b b .      M all nine move: drawn whole, 255
///     b b m m b b      b, m border tiles, resting and moving: decided pixel by pixel
///     b m M M m b
///
/// A pixel of a border tile is decided in this order:
///   1. It does as that one of the nine tiles around it whose depth is most like its own. If that
///   one
///      rests, that is all. A pixel without a depth stays open; only in a moving tile that has no
///      depth either (it is too close to be measured) it moves.
///   2. Where the frame was compared with a picture, a pixel that looks as the scene does rests.
///   3. An open pixel moves if moving pixels lie on both sides of it, at most 24 px apart along its
///      row or else along its column, or if one lies within `grow_px`. Else it is taken for the
///      background: the strip at the left of a near thing, which only the left eye sees.
class MaskOutline {
 public:
  /// The picture with which the frame was compared.
  struct Look {
    const StaticPicture* picture = nullptr;  ///< null: with none, depth alone decides
    /// The picture was drawn for this pose and may be off by a pixel: in a moving tile with a depth
    /// a pixel that looks the same does not count as the scene's.
    bool may_be_off = false;
  };

  /// @param grow_px  how far the mask reaches into pixels of unknown depth at its border
  /// @throws ContractViolation if it is negative
  explicit MaskOutline(int grow_px);

  /// Allocates for depth images of this size.
  void resize(int width, int height);

  /// @param depth       m, NaN where unknown
  /// @param tile_depth  the same of the tiles
  /// @param moves       of the tiles: 1 or 0
  /// @return 255 where something moves, else 0
  const MaskImage& draw(const DepthImage& depth, const DepthImage& tile_depth,
                        const Image<std::uint8_t>& moves, const Look& look);

  /// Per tile of the last mask: 1 where it or a neighbour moves, else 0.
  [[nodiscard]] const Image<std::uint8_t>& near_moving() const { return near_; }

 private:
  void find_border(const Image<std::uint8_t>& moves);
  void draw_border(const DepthImage& depth, const DepthImage& tile_depth,
                   const Image<std::uint8_t>& moves, const Look& look, int i, int j);
  void close_rows();
  void close_columns();

  int grow_px_;
  MaskImage mask_;
  Image<std::uint8_t> near_;                     // per tile: any of the nine tiles around it moves
  Image<std::uint8_t> inside_;                   // per tile: all of them move
  Image<std::uint8_t> any_beside_, all_beside_;  // the same of three tiles of a row
  std::vector<std::uint8_t> row_;                // of tiles, and one more at both ends
  std::vector<std::uint8_t> row_is_empty_;       // per row of tiles: not 0 where the mask is 0
  std::vector<int> open_;                        // pixels that are not decided yet
  MaskImage above_, below_;  // of open pixels: how far the next moving one is in their column
};

}  // namespace palpable
