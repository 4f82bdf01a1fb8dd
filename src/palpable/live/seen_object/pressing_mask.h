/// @file
/// Which pixels of a frame show something that presses a body. There is one answer:
///
///     something presses when it was measured with confidence, and
///     it moves (moving_mask.h), or its place was seen free since the body was anchored
///     (AnchoredScene::was_there)
///
/// So the desk on which a body stands does not press it, a hand does, and so does a cup that was
/// put against it and left there. Before a camera that stands, what comes is seen moving: there a
/// thing that rests was a thing that moved at the same place and depth before, perhaps long ago,
/// and does not look as the scene ever did: a bare desk gets the depth of the finger that has left
/// it.
///
/// Each sign of something that has come may be wrong in single pixels and single frames: along
/// outlines a sensor mixes near and far, a bare desk gets any depth, and a camera that walks knows
/// its own place to a centimetre. So signs are gathered over groups of neighbouring tiles that
/// belong to one surface, and over frames.
///
///   tile  a square of 4 x 4 pixels of the depth image
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/depth/seen_frame.h"
#include "palpable/live/map/anchored_scene.h"
#include "palpable/live/map/free_space.h"
#include "palpable/live/map/moving_mask.h"
#include "palpable/live/map/static_picture.h"
#include "palpable/live/seen_object/color_outline.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct PressingMaskSettings {
  /// A measured point of the room lies at most max(step, sigmas * sigma_Z) before its surface.
  double step = 0.015;  ///< m
  double sigmas = 4;
  /// Before a camera that does not stand a sign is only what stands before the room's surface by
  /// more than max(walking_step, walking_share * Z): its pose is known to a centimetre.
  double walking_step = 0.038;  ///< m; the map's distances reach to 0.040
  double walking_share = 0.03;
  int least_confidence = 160;  ///< of a depth (disparity_filters.h)
  /// Tiles of a group that say so with confidence; fewer are a mismatch. Of what moves the samples
  /// of such tiles are counted, three a tile: of a pencil most tiles see but a part.
  int fewest_tiles = 20;
  /// Of things that rest: only tiles that are not beside something that moves count, where a
  /// matcher gives the room that thing's depth. Of the resting part of a thing that moves so many
  /// are enough.
  int fewest_tiles_beside = 6;
  /// Frames in a row in which a group must have been there, in or near the same tiles.
  int fewest_frames = 3;
  int near_px = 24;  ///< that a group may have gone in a frame: 0.8 m/s at 0.4 m
  /// The moving mask leaves out what looks as the scene did, such as a fingertip before wood. So
  /// many px of what goes on with the same depth, and is no outline of it, belong to the thing,
  /// too. With 0 the unseen side of a finger that rests on the body was off by 2.9 mm (90 of 100)
  /// and its touch flickered, with 3 by 1.3 (`palpable bench surface --only rest --seed 1`).
  int go_on_px = 3;
  ColorOutlineSettings outline{};
};

/// Keeps its memory, and remembers where the last frame had such groups.
class PressingMask {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit PressingMask(const DepthNoise& noise, const PressingMaskSettings& settings = {});

  /// What each pixel shows: kShowsRoom, kShowsPresser or kShowsUnknown (geometry/image.h); of the
  /// room, what lies beside outlines that colours tell, kShowsRoomByColor.
  ///
  ///     measured  it belongs to a group that has come or moves   kShowsPresser
  ///               else                                           kShowsRoom
  ///     not       it does not move, and looks as the room did    kShowsRoom
  ///               else                                           kShowsUnknown
  ///
  /// @param moving     255 where something moves, of the depth's size
  /// @param looked_at  with what the mask was compared (SlamFrame::looked_at)
  /// @param box        the pixels that are asked; all others are kShowsUnknown
  /// @param picture    of a camera that stands: what looks as the scene ever did is the scene,
  ///                   whatever depth a matcher gives it; null: nobody knows how it looks
  /// @return of the depth's size; valid until the next call
  const MaskImage& find(const SeenFrame& seen, const Rigid3& world_from_camera,
                        const MaskImage& moving, LookedAt looked_at, const AnchoredScene& scene,
                        const FreeSpace& space, const PixelBox& box,
                        const StaticPicture* picture = nullptr);

  /// The same where it is not known what moves or where the camera is: kShowsUnknown everywhere.
  const MaskImage& find_nothing(const SeenFrame& seen, const PixelBox& box);

  /// The same where everything that is measured presses, the room too.
  const MaskImage& find_all(const SeenFrame& seen, const PixelBox& box);

 private:
  class Asker;
  struct Tile {
    float depth = 0;         // m, of one of its pixels that moves or has come; 0: none
    bool moves = false;      // most of it does
    bool is_sign = false;    // it says with confidence that its group has come
    bool goes_on = false;    // it rests where a thing was seen moving until now, at the same depth
    std::uint8_t signs = 0;  // of its samples, those that say so while it moves; kMost at most
    std::uint8_t group = 0;  // Group, of the .cpp
  };
  struct Place {
    std::int16_t i, j;
  };

  void resize(const DepthImage& depth, const PixelBox& box);
  void mark_moving(const SeenFrame& seen, const MaskImage& moving, bool looked);
  void find_tile(const SeenFrame& seen, const MaskImage& moving, bool stands,
                 const StaticPicture* picture, int i, int j, Asker& asker);
  void keep_groups();
  void gather(int i, int j);
  [[nodiscard]] std::uint8_t verdict(int frames) const;
  [[nodiscard]] bool beside_moving(int i, int j) const;
  [[nodiscard]] int frames_near(int i, int j) const;
  void mark_pixels(const SeenFrame& seen, const MaskImage& moving, Asker& asker);
  void go_on(const SeenFrame& seen);
  void remember(const SeenFrame& seen, const MaskImage& moving);
  [[nodiscard]] bool was_there_before(int i, int j, float depth) const;
  void remember_moved(const SeenFrame& seen);
  [[nodiscard]] bool is_sure(const SeenFrame& seen, int x, int y) const;
  [[nodiscard]] static bool is_amid_surface(const DepthImage& depth, int x, int y);
  [[nodiscard]] Tile& tile(int i, int j) { return tiles_[index(i, j)]; }
  [[nodiscard]] const Tile& tile(int i, int j) const { return tiles_[index(i, j)]; }
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j - j0_) * static_cast<std::size_t>(across_) +
           static_cast<std::size_t>(i - i0_);
  }

  DepthNoise noise_;
  PressingMaskSettings settings_;
  MaskImage shows_;
  PixelBox box_;
  int i0_ = 0, j0_ = 0, across_ = 0, down_ = 0;  // tiles of the box, counted over the image
  std::vector<Tile> tiles_;
  std::vector<Place> group_;
  // Per tile of the image: frames in a row in which a group was there, in this and the last frame.
  Image<std::uint8_t> frames_, frames_before_;
  // Per tile of the image: the depth of what pressed there last, and of what that has hidden; 0:
  // nothing.
  DepthImage pressed_, hidden_;
  DepthImage moved_;  // per tile: of what moved there until the last frame, or goes on; 0: nothing
  std::vector<Place> edge_, next_edge_;  // pixels
  ColorOutline outline_;
};

}  // namespace palpable
