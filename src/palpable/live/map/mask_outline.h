/// @file
/// Refines a mask of moving tiles to a mask of moving pixels. With whole tiles, the mask would
/// include a rim of the scene around a hand and miss a rim of the hand; here its border follows the
/// edges of depth and of appearance.
///
///   tile  a square of 4 x 4 pixels of the depth image (static_picture.h)
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/map/static_picture.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// Computes the masks of successive frames.
///
///     . . . . . .      . it and its eight neighbours are at rest: 0 for the whole tile
///     . b b b b .      M it and its eight neighbours move: 255 for the whole tile
///     b b m m b b      b, m border tiles, at rest and moving: decided pixel by pixel
///     b m M M m b
///
/// A pixel of a border tile is decided in these steps:
///   1. The pixel takes the state of that tile, among its own and the eight neighbours, whose depth
///      is nearest to its own; "at rest" is final. A pixel without a depth stays undecided, except
///      in a moving tile that has no depth either (it is too close to be measured): there the pixel
///      moves.
///   2. If the frame was compared with a picture, a pixel that looks like the scene is at rest.
///   3. An undecided pixel moves if moving pixels lie on both sides of it, at most 24 px apart
///      along its row or otherwise along its column, or if one lies within `grow_px`. All others
///      are background: the strip at the left of a near thing, which only the left camera sees.
class MaskOutline {
 public:
  /// The picture with which the frame was compared.
  struct Look {
    const StaticPicture* picture = nullptr;  ///< null: there is none, and depth alone decides
    /// The picture was drawn for this pose and may be displaced by a pixel. In a moving tile with a
    /// depth, a pixel that looks the same is then not taken for the scene.
    bool may_be_off = false;
  };

  /// @param grow_px  how far the mask reaches into pixels of unknown depth at its border
  /// @throws ContractViolation if it is negative
  explicit MaskOutline(int grow_px);

  /// Allocates for depth images of this size.
  void resize(int width, int height);

  /// @param depth       m, NaN where unknown
  /// @param tile_depth  per tile: m, NaN where unknown
  /// @param moves       per tile: 1 or 0
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
  Image<std::uint8_t> near_;                     // per tile: it or a neighbour moves
  Image<std::uint8_t> inside_;                   // per tile: it and all its neighbours move
  Image<std::uint8_t> any_beside_, all_beside_;  // the same for three tiles of a row
  std::vector<std::uint8_t> row_;                // a row of tiles, with one more at both ends
  std::vector<std::uint8_t> row_is_empty_;       // per row of tiles: not 0 where the mask is 0
  std::vector<int> open_;                        // indices of pixels that are not decided yet
  MaskImage above_, below_;  // of open pixels: px to the next moving one in their column
};

}  // namespace palpable
