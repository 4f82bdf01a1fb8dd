/// @file
/// Groups of neighbouring tiles that move. A single tile that seems to move is most often a
/// mismatch of the stereo matcher; a hand is a group of them. And a hand that reaches into space
/// which the camera has never seen is not known to move there, but hangs together with the part
/// that is.
///
///   tile  a square of 4 x 4 pixels of the depth image (static_picture.h)
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

struct TileGroupSettings {
  /// Neighbours whose depths differ by less than this share of their depth belong to one thing.
  double same_share = 0.05;
  /// Frames for which a tile goes on moving that moved and is unexplained now; < 127. Without it, a
  /// hand that holds still over unknown ground would be lost between two evident movements.
  int frames_to_carry = 8;
  /// Unexplained tiles may join a group up to this many times its own number. More are a new part
  /// of the scene that the hand touches.
  double most_unexplained = 8;
  int fewest_tiles = 20;  ///< a group of fewer tiles is a mismatch
};

/// Finds the groups, and remembers which tiles moved in the last frames, and at which depth.
class TileGroups {
 public:
  /// What is known of a tile, in rising order of evidence that it moves. Groups are made of
  /// kChanged and above.
  enum Label : std::uint8_t {
    kUnknown,      ///< it has no depth
    kStatic,       ///< it shows the scene
    kUnexplained,  ///< its place was neither seen free, nor is a known surface there
    kChanged,      ///< it has no depth, and does not look as the scene does
    kCarried,      ///< as kUnexplained, but it moved at that depth a moment ago
    kMoving,       ///< its place was seen free, or lies before a known surface
  };

  /// @throws ContractViolation for settings out of their range
  explicit TileGroups(const TileGroupSettings& settings = {});

  /// Allocates for images of width x height tiles, and forgets everything.
  void resize(int width, int height);

  /// The label of a tile that nothing explains: kCarried where it moved at its depth (m) a moment
  /// ago, else kUnexplained.
  [[nodiscard]] Label label_of_unexplained(int i, int j, float depth) const;

  /// Decides of each tile that may move whether it does.
  ///
  ///     1. Tiles of kChanged and above that touch each other are a group.
  ///     2. A group of fewer than fewest_tiles becomes static.
  ///     3. Unexplained tiles join a group when a chain of neighbours leads to them from its border
  ///        without a jump in depth, and they lie no deeper than the group (two deviations beyond
  ///        its mean, and a tenth). If they are more than most_unexplained times the group, all of
  ///        them stay unexplained.
  ///
  /// @param depth  of the tiles, m, NaN where unknown
  /// @param label  in: of the tiles; out: kMoving or kStatic instead of kChanged and kCarried
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
  Image<std::uint8_t> state_;  // of this frame's tiles (State)
  Image<std::uint8_t> age_;    // frames since the tile was seen to move; 127: longer ago
  DepthImage moved_depth_;     // the tile's depth then
  std::vector<Tile> group_;    // the tiles of the group that is being made
  std::vector<Tile> edge_;     // those of them beside which tiles may join; then those that join
};

}  // namespace palpable
