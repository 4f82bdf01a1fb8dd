/// @file
/// Finds which pixels of a frame show a presser: something that may press a body. One rule decides:
///
///     a pixel shows a presser when its depth was measured with confidence, and
///     it moves (moving_mask.h), or its position was seen free since the body was anchored
///     (AnchoredScene::was_there)
///
/// So the desk on which a body stands is no presser; a hand is one, and so is a cup that was put
/// against the body and left there. A camera that stands sees every thing move when it arrives.
/// There, a thing that rests counts only if something moved at the same pixels and depth before,
/// perhaps long ago, and only if the picture differs from what the scene has always looked like.
/// The second condition excludes a bare desk to which the matcher still gives the depth of a finger
/// that has left.
///
/// Each single sign may be wrong in single pixels and single frames: along outlines a sensor mixes
/// near and far depths, a bare desk gets arbitrary depths, and the pose of a walking camera is
/// known only to a centimetre. So signs are counted over groups of neighbouring tiles that belong
/// to one surface, and over several frames.
///
///   tile  a square of 4 x 4 pixels of the depth image
///   sign  a tile that shows, with confidence, something that arrived since the body was anchored
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
#include "palpable/live/seen_object/outline_search.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct PressingMaskSettings {
  /// A measured point counts as part of the room unless it lies nearer to the camera than the
  /// room's surface by more than max(step, sigmas * sigma_Z). Larger values miss thin things that
  /// lie on the room; smaller ones take noise for a presser.
  double step = 0.015;  ///< m
  double sigmas = 4;    ///< standard deviations of the depth
  /// The same bound for a camera that does not stand, max(walking_step, walking_share * Z): it is
  /// larger because the camera's pose is known only to a centimetre.
  double walking_step = 0.038;  ///< m; the map stores distances up to 0.040
  double walking_share = 0.03;  ///< ratio to Z
  int least_confidence = 160;   ///< of a depth, 0 .. 255 (disparity_filters.h)
  /// Signs that a group must have; a group with fewer is taken for a mismatch. In moving tiles the
  /// samples are counted instead, three for a tile, because a thin thing such as a pencil fills
  /// most of its tiles only in part.
  int fewest_tiles = 20;
  /// The same for the resting part of a group that lies beside something that moves. Resting tiles
  /// next to moving ones are not counted, because there a matcher gives the room the depth of the
  /// moving thing.
  int fewest_tiles_beside = 6;
  /// Number of consecutive frames in which a group must have been seen in or near the same tiles.
  int fewest_frames = 3;
  int near_px = 24;  ///< px that a group may move in one frame: 0.8 m/s at 0.4 m
  /// px by which a presser is extended into neighbouring pixels of the same surface. The moving
  /// mask leaves out pixels that look as the scene did, such as a fingertip before wood. With 0 the
  /// unseen side of a finger that rests on the body was off by 2.9 mm (90th percentile) and its
  /// touch flickered; with 3 it was off by 1.3 mm
  /// (`palpable bench surface --only rest --seed 1`).
  int go_on_px = 3;
  ColorOutlineSettings outline{};
  OutlineSearchSettings search{};
};

/// Finds the mask of each frame. Groups are connected tiles of moving pixels; where they were in
/// the last frame decides which of this frame's groups are the same things. Memory is allocated
/// once.
class PressingMask {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit PressingMask(const DepthNoise& noise, const PressingMaskSettings& settings = {});

  /// Finds what each pixel shows: kShowsRoom, kShowsPresser or kShowsUnknown (geometry/image.h);
  /// kShowsRoomByColor for the room beside outlines that were confirmed by colour, and
  /// kShowsRoomByEdge for that beside outlines that were found in the picture.
  ///
  ///     depth measured      the pixel belongs to a group that is a presser     kShowsPresser
  ///                         else                                               kShowsRoom
  ///     depth not measured  it does not move, is not too close, and
  ///                         looked_at is not kNothing                          kShowsRoom
  ///                         else                                               kShowsUnknown
  ///
  /// @param moving     255 where something moves, of the depth's size
  /// @param looked_at  what the frame was compared with to find `moving` (SlamFrame::looked_at)
  /// @param box        the pixels to be classified; all others are kShowsUnknown
  /// @param picture    of a camera that stands: tiles that look as the scene always did belong to
  ///                   the room, whatever depth a matcher gives them; null: no picture is known
  /// @return of the depth's size; valid until the next call
  const MaskImage& find(const SeenFrame& seen, const Rigid3& world_from_camera,
                        const MaskImage& moving, LookedAt looked_at, const AnchoredScene& scene,
                        const FreeSpace& space, const PixelBox& box,
                        const StaticPicture* picture = nullptr);

  /// The share of each pixel that shows a presser, in the box of the last find()
  /// (OutlineSearch::coverage()), undefined outside of it; null after the other two functions, and
  /// where the pose was not finite.
  [[nodiscard]] const Image<float>* coverage() const {
    return is_searched_ ? &search_.coverage() : nullptr;
  }

  /// The mask when motion or the camera's pose is not known: kShowsUnknown everywhere.
  const MaskImage& find_nothing(const SeenFrame& seen, const PixelBox& box);

  /// The mask that takes every measured pixel for a presser, the room included.
  const MaskImage& find_all(const SeenFrame& seen, const PixelBox& box);

 private:
  class RoomTest;
  struct Tile {
    float depth = 0;         // m, of one of its pixels that moves or arrived; 0: there is none
    bool moves = false;      // most of its samples do
    bool is_sign = false;    // see the head of the file
    bool goes_on = false;    // it rests at the depth at which something moved until the last frame
    std::uint8_t signs = 0;  // confident samples of a tile with moving samples; at most kMost
    std::uint8_t group = 0;  // Group, of the .cpp
  };
  struct Place {
    std::int16_t i, j;
  };

  void resize(const DepthImage& depth, const PixelBox& box);
  void mark_moving(const SeenFrame& seen, const MaskImage& moving, bool looked);
  void find_tile(const SeenFrame& seen, const MaskImage& moving, bool stands,
                 const StaticPicture* picture, int i, int j, RoomTest& room);
  void keep_groups();
  void gather(int i, int j);
  [[nodiscard]] std::uint8_t verdict(int frames) const;
  [[nodiscard]] bool beside_moving(int i, int j) const;
  [[nodiscard]] int frames_near(int i, int j) const;
  void mark_pixels(const SeenFrame& seen, const MaskImage& moving, RoomTest& room);
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
  // Per tile of the image: the number of consecutive frames in which a group was there, up to this
  // frame and up to the last one.
  Image<std::uint8_t> frames_, frames_before_;
  // Per tile of the image: the depth (m) of the presser seen there last, and the depth of an
  // earlier presser that it hides; 0: there was none.
  DepthImage pressed_, hidden_;
  DepthImage
      moved_;  // per tile: m, of what moved there until the last frame, or rests since; 0: none
  std::vector<Place> edge_, next_edge_;  // pixels
  ColorOutline outline_;
  OutlineSearch search_;
  bool is_searched_ = false;
};

}  // namespace palpable
