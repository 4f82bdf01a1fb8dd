/// @file
/// Groups of neighbouring tiles that move. A single tile that seems to move is most often a
/// mismatch of the stereo matcher, whereas a hand covers a group of tiles. Where a hand reaches
/// into space that the camera has never seen, its tiles give no evidence of motion; they are found
/// because they are connected to tiles that do.
///
///   tile  a square of 4 x 4 pixels of the depth image (static_picture.h)
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

struct TileGroupSettings {
  /// Neighbours whose depths differ by less than this share of their depth belong to one object.
  double same_share = 0.05;
  /// Frames for which a tile that moved and is now unexplained still counts as moving; < 127.
  /// Without it, a hand that holds still over unseen ground would be lost between two movements.
  int frames_to_carry = 8;
  /// Largest ratio of the unexplained tiles that join a group to the group's own tiles. If more
  /// could join, they are a new part of the scene that the hand touches, and none joins.
  double most_unexplained = 8;
  int fewest_tiles = 20;  ///< a group of fewer tiles is a mismatch
};

/// Finds the groups, and stores which tiles moved in the last frames and at which depth.
class TileGroups {
 public:
  /// State of knowledge about a tile, in rising order of evidence that it moves. Groups consist of
  /// tiles of kChanged and above.
  enum Label : std::uint8_t {
    kUnknown,      ///< it has no depth
    kStatic,       ///< it shows the scene
    kUnexplained,  ///< its point was never seen free, and no known surface is there
    kChanged,      ///< it has no depth, and does not look like the scene
    kCarried,      ///< as kUnexplained, but it moved at that depth a moment ago
    kMoving,       ///< its point was seen free, or lies in front of a known surface
  };

  /// @throws ContractViolation for settings out of their range
  explicit TileGroups(const TileGroupSettings& settings = {});

  /// Allocates for images of width x height tiles, and deletes the history.
  void resize(int width, int height);

  /// The label of an unexplained tile: kCarried if it moved at this depth (m) a moment ago,
  /// otherwise kUnexplained.
  [[nodiscard]] Label label_of_unexplained(int i, int j, float depth) const;

  /// Decides for each tile that may move whether it does.
  ///
  ///     1. Tiles of kChanged and above that touch each other are a group.
  ///     2. A group of fewer than fewest_tiles becomes static.
  ///     3. Unexplained tiles join a group when a chain of neighbours leads to them from its border
  ///        without a jump in depth, and their depth is at most 1.1 (mean + 2 standard deviations)
  ///        of the group's depths. If they are more than most_unexplained times the group, none of
  ///        them joins.
  ///
  /// @param depth  per tile: m, NaN where unknown
  /// @param label  per tile; in: any label; out: kMoving or kStatic instead of kChanged, kCarried
  /// @return whether anything moves
  bool find(const DepthImage& depth, Image<std::uint8_t>& label);

 private:
  struct Tile {
    std::int16_t i, j;
  };

  [[nodiscard]] float deepest_of_group(const DepthImage& depth) const;
  void gather_group(std::size_t first);
  void add_unexplained(const DepthImage& depth);
  void mark_moving(const DepthImage& depth, bool is_evident, Image<std::uint8_t>& label);

  TileGroupSettings settings_;
  Image<std::uint8_t> state_;  // per tile of this frame (State)
  Image<std::uint8_t> age_;    // per tile: frames since there was evidence of motion; 127: or more
  DepthImage moved_depth_;     // per tile: its depth when it last moved, m
  std::vector<Tile> group_;    // the tiles of the present group
  std::vector<Tile> edge_;     // those of them that have unexplained neighbours; then the joined
};

}  // namespace palpable
