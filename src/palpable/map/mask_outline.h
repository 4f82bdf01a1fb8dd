/// @file
/// From tiles that move to pixels: the mask follows the border of depth and look.
///
///   tile  a square of 4 x 4 pixels of the depth image (static_picture.h)
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/map/static_picture.h"

#include <cstdint>
#include <vector>

namespace palpable {

/// Draws the mask of one frame after the other.
///
/// A tile that moves or does not as all its neighbours do is drawn whole. Else its pixels take over
/// from the tile around them whose depth is most like theirs, and what they look like goes before
/// that. Pixels of unknown depth in such a tile move if what moves lies on both sides of them
/// within 24 px, along their row or else their column, and so do the next `grow_px` beside it. The
/// strip at the left of a near thing, which only the left eye sees, is the background's beyond
/// that.
class MaskOutline {
 public:
  /// How a frame looks, where it was compared.
  struct Look {
    const StaticPicture* picture = nullptr;  ///< null: depth alone decides
    bool may_be_off = false;                 ///< by a pixel, so a known depth says more than it
  };

  /// @throws ContractViolation if a margin is negative
  explicit MaskOutline(int grow_px);

  /// Takes the memory for depth images of so many pixels.
  void resize(int width, int height);

  /// @param depth       m, NaN where unknown
  /// @param tile_depth  the same of the tiles
  /// @param moves       of the tiles: 1 or 0
  /// @return 255 where something moves, else 0
  const MaskImage& draw(const DepthImage& depth, const DepthImage& tile_depth,
                        const Image<std::uint8_t>& moves, const Look& look);

  /// Of the last mask's tiles: 1 where one or a neighbour moves, else 0.
  [[nodiscard]] const Image<std::uint8_t>& near_moving() const { return near_; }

 private:
  void find_border(const Image<std::uint8_t>& moves);
  void draw_border(const DepthImage& depth, const DepthImage& tile_depth,
                   const Image<std::uint8_t>& moves, const Look& look, int i, int j);
  void close_rows();
  void close_columns();

  int grow_px_;
  MaskImage mask_;
  Image<std::uint8_t> near_, inside_;  // of tiles: they or a neighbour move; with all of theirs
  Image<std::uint8_t> any_beside_, all_beside_;
  std::vector<std::uint8_t> row_;           // of tiles, and one more at both ends
  std::vector<std::uint8_t> row_is_empty_;  // of tiles: not 0 where the mask is 0
  std::vector<int> open_;                   // pixels that are not decided yet
  MaskImage above_, below_;
};

}  // namespace palpable
