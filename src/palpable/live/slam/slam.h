/// @file
/// Finds the camera's pose, the moving pixels and the surface of the room (paper Sec. 3.3: SLAM
/// with dynamic objects kept out of the map). Each of the three depends on another one, so a frame
/// is processed in this order:
///
///     predict the pose from the last motion
///       -> find the moving pixels, as seen from there      (map/moving_mask.h)
///       -> find the pose, without moving pixels            (track/tracker.h)
///       -> mark the space through which the camera looked  (map/free_space.h)
///       -> fuse the rest of the depth image into the map   (map/surface_map.h)
///
/// World frame: the first keyframe's camera, m. No result depends on a clock: the same frames give
/// the same bytes.
#pragma once

#include "palpable/common/base/stage_clock.h"
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
  bool track = true;  ///< false: the camera is assumed to stand still
  bool map = true;    ///< false: only the pose is computed; no mask, no map
  double fuse_every =
      0.1;  ///< s, by the source's time, between depth images that are fused; 0: all
  /// Largest share of the picture that a mask may cover. A larger mask is probably the result of a
  /// wrongly predicted pose: it is not used, and the frame changes neither map nor free space. The
  /// limit does not apply while the camera stands still, because then no pose is predicted.
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
  const MaskImage* borrowed = nullptr;      ///< MovingMask::borrowed(); null if `moving` is null
  LookedAt looked_at = LookedAt::kNothing;  ///< the picture with which the frame was compared
  const StaticPicture* picture = nullptr;   ///< that picture; null unless looked_at is kPicture
  bool fused = false;                       ///< its depth image was fused into the map
  /// Not empty: a loop was closed with this frame, and map and free space were cleared. The caller
  /// can use these to correct the poses of its own objects in the world. Valid until the next
  /// frame.
  std::span<const Correction> corrections;
};

/// Statistics since the construction, for benchmarks. CPU times are of the calling thread.
struct SlamCounts {
  int frames = 0;
  int lost = 0;           ///< frames without a pose
  int masks = 0;          ///< frames in which a mask was found
  int fused = 0;          ///< frames whose depth image was fused
  double mask_cpu_s = 0;  ///< s, for masks and free space
  double fuse_cpu_s = 0;  ///< s
};

/// Allocates in its constructor and in the first frames; the map goes on allocating as more of the
/// room is seen.
class Slam {
 public:
  /// @param camera  the source of the frames that are passed to advance()
  /// @throws ContractViolation for settings out of their range
  explicit Slam(const DepthCamera& camera, const SlamSettings& settings = {});

  /// Processes the next frame. The mask is found with a pose that is predicted from the last motion
  /// and the source's time; after missing frames the motion is extrapolated by a factor of up to
  /// three. While the camera is lost there is no mask, and map and free space do not change; the
  /// first mask is that of the second frame after the pose was found again. When a loop is closed
  /// the map is cleared, because it was fused with drifted poses.
  /// @param times  receives the stages "map" and "track"
  const SlamFrame& advance(const SeenFrame& seen, StageTimes& times);

  /// Processes the next frame with a given pose instead of tracking.
  /// @param world_from_camera  nothing: the pose is not known, and the frame counts as lost
  const SlamFrame& advance(const SeenFrame& seen, const std::optional<Rigid3>& world_from_camera,
                           StageTimes& times);

  /// The surface of the scene so far; null without SlamSettings::map.
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
  MaskImage unfit_;  // 255 where the depth is not that of the static scene
  // The result of the last frame. Before the first frame the pose is the identity.
  TrackedPose last_camera_{.state = TrackState::kFixed};
  const MaskImage* large_mask_ = nullptr;         // this frame's mask, if it covers too much
  Rigid3 before_from_last_ = Rigid3::Identity();  // the motion between the last two frames
  double last_time_ = 0;                          // s
  double last_motion_time_ = 0;                   // s, duration of that motion; 0: unknown
  double last_fused_ = -std::numeric_limits<double>::infinity();  // s
  SlamCounts counts_;
};

}  // namespace palpable
