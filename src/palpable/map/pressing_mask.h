/// @file
/// Which pixels of a frame show something that presses a body. There is one answer:
///
///     something presses when it was measured with confidence, and
///     it moves (moving_mask.h), or its place was seen free since the body was anchored
///     (AnchoredScene::was_there)
///
/// So the desk on which a body stands does not press it, a hand does, and so does a cup that was
/// put against it and left there.
///
///   tile  a square of 4 x 4 pixels of the depth image
#pragma once

#include "palpable/depth/depth_noise.h"
#include "palpable/depth/seen_frame.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/pixel_box.h"
#include "palpable/geometry/rigid.h"
#include "palpable/map/anchored_scene.h"
#include "palpable/map/free_space.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace palpable {

struct PressingMaskSettings {
  /// A measured point of the room lies at most max(step, sigmas * sigma_Z) before its surface.
  double step = 0.015;  ///< m
  double sigmas = 4;
  /// Things that have come and rest now are groups of at least so many tiles: along outlines of the
  /// room a matcher gives the pixels beside a near thing that thing's depth.
  int fewest_tiles = 20;
  int fewest_tiles_beside = 6;  ///< of the resting part of a thing that moves
};

/// Keeps its memory.
class PressingMask {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit PressingMask(const DepthNoise& noise, const PressingMaskSettings& settings = {});

  /// What each pixel shows: kShowsRoom, kShowsPresser or kShowsUnknown (geometry/image.h).
  ///
  ///     measured  it moves, or its group of tiles has come since   kShowsPresser
  ///               else                                             kShowsRoom
  ///     not       it does not move, and looks as the room did      kShowsRoom
  ///               else                                             kShowsUnknown
  ///
  /// @param moving  255 where something moves, of the depth's size; null: not known, and then
  ///                nothing is known of any pixel
  /// @param looked  the mask compared looks: where nothing moves and no depth is known, the room is
  ///                seen (SlamFrame::looked)
  /// @param box     the pixels that are asked; all others are kShowsUnknown
  /// @return of the depth's size; valid until the next call
  const MaskImage& find(const SeenFrame& seen, const Rigid3& world_from_camera,
                        const MaskImage* moving, bool looked, const AnchoredScene& scene,
                        const FreeSpace& space, const PixelBox& box);

  /// The same where everything that is measured presses, the room too.
  const MaskImage& find_all(const SeenFrame& seen, const PixelBox& box);

 private:
  class Asker;
  void mark_moving(const SeenFrame& seen, const MaskImage& moving, bool looked,
                   const PixelBox& box);
  void find_come_tiles(const SeenFrame& seen, const MaskImage& moving, const PixelBox& box,
                       Asker& asker);
  void keep_large_groups();
  void mark_come_pixels(const SeenFrame& seen, const PixelBox& box, Asker& asker);

  DepthNoise noise_;
  PressingMaskSettings settings_;
  MaskImage shows_;
  Image<std::uint8_t> tiles_;  // of the box (State in the .cpp)
  std::vector<std::pair<int, int>> group_;
};

}  // namespace palpable
