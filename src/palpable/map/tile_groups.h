/// @file
/// What moves hangs together: groups of tiles of a depth image.
///
///   tile  a square of 4 x 4 pixels of the depth image (static_picture.h)
#pragma once

#include "palpable/geometry/image.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

struct TileGroupSettings {
  /// Neighbours whose depths differ by less than this share of them belong to one thing.
  double same_share = 0.05;
  /// What moved so many frames ago or less, and is explained by nothing now, goes on moving; < 127.
  int frames_to_carry = 8;
  double most_unexplained = 8;  ///< tiles that join a moving group, times its own number
  int fewest_tiles = 20;        ///< a connected group of fewer tiles is noise
};

/// Makes groups of tiles, and remembers what moved where in the last frames.
class TileGroups {
 public:
  /// What is said of a tile; from kChanged on it may be of something that moves.
  enum Label : std::uint8_t {
    kUnknown,      ///< without a depth
    kStatic,       ///< of the scene
    kUnexplained,  ///< nothing known lies there, and nobody has seen it free
    kChanged,      ///< without a depth, and it does not look as the scene does
    kCarried,      ///< unexplained, and it moved at that depth a moment ago
    kMoving,
  };

  /// @throws ContractViolation for settings out of their range
  explicit TileGroups(const TileGroupSettings& settings = {});

  /// Takes the memory for images of so many tiles, and forgets.
  void resize(int width, int height);

  /// kCarried where a tile without explanation moved at its depth (m) a moment ago, else
  /// kUnexplained.
  [[nodiscard]] Label unexplained(int i, int j, float depth) const;

  /// Groups of tiles that move, or moved a moment ago and are not explained now, or have changed;
  /// small ones are mismatches, and static. Then the unexplained tiles that continue a group's
  /// depth without a jump and lie no deeper than it does: they move with it. Where they are many
  /// times the group, it is a new part of the scene that something touches: they stay.
  ///
  /// @param depth  of the tiles, m, NaN where unknown
  /// @param label  in: of the tiles; out: no longer kChanged or kCarried, but static or moving
  /// @return whether anything moves
  bool find(const DepthImage& depth, Image<std::uint8_t>& label);

 private:
  struct Tile {
    std::int16_t i, j;
  };

  [[nodiscard]] float deepest_of_group(const DepthImage& depth) const;
  void gather(std::size_t first);
  void join(const DepthImage& depth);

  TileGroupSettings settings_;
  Image<std::uint8_t> state_;  // of this frame's tiles
  Image<std::uint8_t> age_;    // frames since it was seen to move; 127: long ago
  DepthImage moved_depth_;     // its depth then
  std::vector<Tile> group_;
  std::vector<Tile> edge_;  // those of them with tiles beside them that may join, then these
};

}  // namespace palpable
