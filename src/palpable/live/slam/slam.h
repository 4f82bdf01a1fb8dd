/// @file
/// Finds where the camera is, what moves and what the room looks like (paper Sec. 3.3: SLAM with
/// dynamic objects kept out of the map). Each of the three needs another, so a frame goes through
/// them in this order:
///
///     predict the pose from the last motion
///       -> find what moves, as seen from there             (map/moving_mask.h)
///       -> find the pose, without what moves               (track/tracker.h)
///       -> learn through which space the camera looked     (map/free_space.h)
///       -> fuse the rest of the depth image into the map   (map/surface_map.h)
///
/// World frame: the first keyframe's camera, m. No result depends on a clock: the same frames give
/// the same bytes.
#pragma once

#include "palpable/common/base/stage_clock.h"
#include "palpable/common/geometry/correction.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/map/moving_mask.h"
#include "palpable/live/map/surface_map.h"
#include "palpable/live/track/tracker.h"

#include <limits>
#include <optional>
#include <span>

namespace palpable {

struct SlamSettings {
  bool track = true;  ///< false: the camera is taken to stand where it was in the first frame
  bool map = true;    ///< false: the camera alone is followed; no mask, no map
  double fuse_every =
      0.1;  ///< s, by the source's time, between depth images that are fused; 0: all
  /// Share of the picture. A mask that covers more comes from a wrongly predicted pose: it is not
  /// used, and nothing is learnt from its frame. Only of a camera that stands, whose pose is not
  /// predicted, such a mask is used.
  double most_moving = 0.7;
  MovingMaskSettings moving{};
  SurfaceMapSettings surface{};
};

/// The result of one frame.
struct SlamFrame {
  TrackedPose camera;
  /// 255 where something moves, of the depth's size. Null without SlamSettings::map, when the mask
  /// covers too much, and while the camera is lost or was in the frame before. Valid until the next
  /// frame.
  const MaskImage* moving = nullptr;
  const MaskImage* borrowed = nullptr;      ///< MovingMask::borrowed(); null where `moving` is
  LookedAt looked_at = LookedAt::kNothing;  ///< with what the mask's frame was compared
  const StaticPicture* picture = nullptr;   ///< that one; null unless looked_at is kPicture
  bool fused = false;                       ///< its depth image was fused into the map
  /// Not empty: a loop was closed with this frame, and map and free space began anew. What others
  /// have placed in the world can be moved by these. Valid until the next frame.
  std::span<const Correction> corrections;
};

/// What has been done so far, for benches. CPU times are of the calling thread.
struct SlamCounts {
  int frames = 0;
  int lost = 0;           ///< frames without a pose
  int masks = 0;          ///< frames in which a mask was found
  int fused = 0;          ///< frames whose depth image was fused
  double mask_cpu_s = 0;  ///< s, for finding masks and learning what is free
  double fuse_cpu_s = 0;  ///< s
};

/// Allocates in its constructor and in the first frames; the map goes on allocating as more of the
/// room is seen.
class Slam {
 public:
  /// @param camera  makes the frames that advance() gets
  /// @throws ContractViolation for settings out of their range
  explicit Slam(const DepthCamera& camera, const SlamSettings& settings = {});

  /// Processes the next frame. The pose from which the mask is found is predicted from the last
  /// motion, by the source's time: after a gap up to three times as far. While the camera is lost,
  /// nothing is learnt and there is no mask; the first mask is that of the second frame after it
  /// has come back. When a loop is closed the map begins anew: it was fused from wrong poses.
  /// @param times  gets the stages "map" and "track"
  const SlamFrame& advance(const SeenFrame& seen, StageTimes& times);

  /// Processes the next frame with a pose that is known from elsewhere, instead of tracking.
  /// @param world_from_camera  nothing: the pose is not known, and the frame counts as lost
  const SlamFrame& advance(const SeenFrame& seen, const std::optional<Rigid3>& world_from_camera,
                           StageTimes& times);

  /// The scene as it has been seen so far; null without SlamSettings::map.
  [[nodiscard]] const SurfaceMap* map() const { return map_ ? &*map_ : nullptr; }
  /// The space that was seen free; null without SlamSettings::map.
  [[nodiscard]] const FreeSpace* space() const { return mover_ ? &mover_->space() : nullptr; }
  /// Null without SlamSettings::track.
  [[nodiscard]] const Tracker* tracker() const { return tracker_ ? &*tracker_ : nullptr; }
  [[nodiscard]] const SlamCounts& counts() const { return counts_; }
  [[nodiscard]] const SlamSettings& settings() const { return settings_; }

 private:
  const SlamFrame& advance_at(const TrackedPose& camera, const SeenFrame& seen, StageTimes& times);
  void find_moving(const SeenFrame& seen, const Rigid3& world_from_camera);
  [[nodiscard]] Rigid3 predicted_pose(double time) const;
  void learn(const SeenFrame& seen);
  void begin_map();

  SlamSettings settings_;
  DepthNoise noise_;
  std::optional<Tracker> tracker_;
  std::optional<MovingMask> mover_;
  std::optional<SurfaceMap> map_;
  SlamFrame frame_;
  MaskImage unfit_;  // 255 where the depth is not the scene's
  // Of the last frame. Before the first one the camera stands where the world begins.
  TrackedPose last_camera_{.state = TrackState::kFixed};
  const MaskImage* large_mask_ = nullptr;         // this frame's mask, when it covers too much
  Rigid3 before_from_last_ = Rigid3::Identity();  // the last motion, from the frame before the last
  double last_time_ = 0;                          // s
  double last_motion_time_ = 0;                   // s that it took; 0: unknown
  double last_fused_ = -std::numeric_limits<double>::infinity();  // s
  SlamCounts counts_;
};

}  // namespace palpable
