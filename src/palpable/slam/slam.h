/// @file
/// Where the camera is, what moves and what the room looks like, in the order in which they need
/// one another (paper Sec. 3.3: SLAM with dynamic objects kept out of the map):
///
///     what moves, seen from where the camera should be by now  ->  track without it
///         ->  learn where the camera looked through  ->  fuse the rest into the map
///
/// World frame: the first frame's camera, m. Nothing here looks at a clock except to say how long
/// something took: the same frames give the same bytes.
#pragma once

#include "palpable/base/stage_clock.h"
#include "palpable/depth/depth_camera.h"
#include "palpable/geometry/correction.h"
#include "palpable/geometry/frame.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"
#include "palpable/map/moving_mask.h"
#include "palpable/map/surface_map.h"
#include "palpable/track/tracker.h"

#include <limits>
#include <optional>
#include <span>

namespace palpable {

struct SlamSettings {
  /// Follow the camera. false: it is taken to stand where it stood in the first frame.
  bool track = true;
  /// Find what moves and fuse the rest. false: the camera alone is followed.
  bool map = true;
  /// s of the source's time between two depth images that go into the map; 0: all of them.
  double fuse_every = 0.1;
  /// A mask that covers more of the picture than this is not used, and nothing is learnt from its
  /// frame: the pose from which it was found is wrong. One of a camera that stands is: there is no
  /// pose to be wrong.
  double most_moving = 0.7;
  MovingMaskSettings moving{};
  SurfaceMapSettings surface{};
};

/// What one frame says.
struct SlamFrame {
  TrackedPose camera;
  /// 255 where something moves, of the depth's size; null when it is not looked for, when it covers
  /// too much, or when the camera is or was lost. Valid until the next frame.
  const MaskImage* moving = nullptr;
  bool fused = false;  ///< the frame went into the map
  /// Not empty: a loop was closed in this frame, map and free space began anew, and what was
  /// remembered elsewhere may follow. Valid until the next frame.
  std::span<const Correction> corrections;
};

/// What it has done so far, for benches: CPU seconds of the calling thread.
struct SlamCounts {
  int frames = 0;
  int lost = 0;           ///< frames without a pose
  int masks = 0;          ///< frames in which what moves was looked for
  int fused = 0;          ///< frames that went into the map
  double mask_cpu_s = 0;  ///< finding what moves and learning what is free
  double fuse_cpu_s = 0;
};

/// Takes its memory when it is made and in the first frames, the map's as the room is seen.
class Slam {
 public:
  /// For frames of `format` that `camera` has seen.
  /// @throws ContractViolation for settings out of their range
  Slam(const DepthCamera& camera, const FrameFormat& format, const SlamSettings& settings = {});

  /// Takes in the next frame. While the camera is lost nothing is learnt; what moves is looked for
  /// again in the second frame after it has come back, since the pose of the next frame is foretold
  /// from the last motion, by the source's time: up to three times as far. When a loop is closed
  /// the map begins anew: it was fused where the camera was not.
  /// @param times  gets the stages "map" and "track"
  const SlamFrame& advance(const SeenFrame& seen, StageTimes& times);

  /// The same with a pose that is known from elsewhere: nothing is tracked.
  /// @param world_from_camera  nothing: nobody knows; the frame counts as lost
  const SlamFrame& advance(const SeenFrame& seen, const std::optional<Rigid3>& world_from_camera,
                           StageTimes& times);

  /// The scene as it has been seen so far; null without SlamSettings::map.
  [[nodiscard]] const SurfaceMap* map() const { return map_ ? &*map_ : nullptr; }
  /// Where the scene was seen free; null without SlamSettings::map.
  [[nodiscard]] const FreeSpace* space() const { return mover_ ? &mover_->space() : nullptr; }
  /// Null without SlamSettings::track.
  [[nodiscard]] const Tracker* tracker() const { return tracker_ ? &*tracker_ : nullptr; }
  [[nodiscard]] const SlamCounts& counts() const { return counts_; }
  [[nodiscard]] const SlamSettings& settings() const { return settings_; }

 private:
  const SlamFrame& take(const SeenFrame& seen, const TrackedPose& camera, StageTimes& times);
  void find_moving(const SeenFrame& seen, const Rigid3& world_from_camera);
  [[nodiscard]] Rigid3 foretold(double time) const;
  void learn(const SeenFrame& seen);
  void begin_map();

  SlamSettings settings_;
  DepthNoise noise_;
  std::optional<Tracker> tracker_;
  std::optional<MovingMask> mover_;
  std::optional<SurfaceMap> map_;
  SlamFrame frame_;
  // Of the frame before. Before the first one the camera stands where the world begins.
  TrackedPose last_camera_{.state = TrackState::kFixed};
  const MaskImage* large_ = nullptr;         // this frame's mask, when it covers too much
  Rigid3 last_motion_ = Rigid3::Identity();  // from the frame before it: before_from_last
  double last_time_ = 0;                     // s
  double last_step_ = 0;                     // s that last_motion_ took; 0: unknown
  double last_fused_ = -std::numeric_limits<double>::infinity();
  SlamCounts counts_;
};

}  // namespace palpable
