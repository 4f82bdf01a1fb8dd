/// @file
/// Where the camera is, frame after frame (paper Sec. 3.3: stereo SLAM).
///
/// Points are kept with the patch in which they were first seen, and looked for again in every
/// frame: warped and smeared as the predicted motion says, first in small images, then in large
/// ones. The pose comes from those found (pose_fit.h); now and then a frame is kept, gives new
/// points, and poses and points of the last keyframes are adjusted together (bundle.h). A camera
/// that is lost is recognised by its features (recogniser.h), and so is ground to which one comes
/// back with too much drift to find its landmarks (loop.h); a camera that stands still costs next
/// to nothing (still_watch.h). docs/tracking.md says why it is so and how well it does.
///
/// The world is the camera frame of the first frame. Same frames, same poses to the bit, whether
/// the adjustment runs on a thread of its own or not: its result is taken over a fixed number of
/// frames after it was asked for.
#pragma once

#include "palpable/depth/depth_noise.h"
#include "palpable/geometry/correction.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"
#include "palpable/track/map_limits.h"
#include "palpable/track/sighting.h"

#include <memory>
#include <span>
#include <vector>

namespace palpable {

/// One moment, as the depth camera has prepared it. Pointers are read during the call only.
struct TrackerFrame {
  int number = 0;
  double time = 0;                    ///< s, of the source; rising
  const GrayImage* left = nullptr;    ///< luma, rectified, of TrackCamera's size
  const GrayImage* right = nullptr;   ///< the same of the right eye; null: depth alone is measured
  const DepthImage* depth = nullptr;  ///< Z in m of the same view, as large or half as large
  /// 255 where something moves, of the depth's size; or null. Left out of everything.
  const MaskImage* moving = nullptr;
};

enum class TrackState {
  kStarting,  ///< nothing to follow yet; as far as can be seen it stands where it began
  kFixed,     ///< it stands still; the pose is that of the moment since when it does
  kTracking,  ///< it moves, and the pose is known
  /// The pose is not known; what is given is the last one that was. So is a camera that has moved,
  /// or shows nothing at all, before anything could be followed.
  kLost
};

struct TrackedPose {
  Rigid3 world_from_camera = Rigid3::Identity();
  TrackState state = TrackState::kStarting;
  int landmarks = 0;      ///< that carried it; 0 when kFixed or kLost
  int tried = 0;          ///< that were looked for
  bool keyframe = false;  ///< this frame was kept
  /// A loop was closed: what was placed by the poses between may be off by their drift
  /// (Tracker::corrections).
  bool closed_loop = false;
  /// The first pose of a camera that was lost before: the world begins here, and what was placed
  /// while it stood elsewhere lies nobody knows where.
  bool new_world = false;
  int newest_keyframe = -1;  ///< the frame number of the newest one; -1: none
  /// Where the camera stood in it: with Tracker::keyframes() the pose of this frame as corrected
  /// since.
  Rigid3 keyframe_from_camera = Rigid3::Identity();
};

/// Whether a frame's points can be said to lie somewhere in the world.
[[nodiscard]] inline bool is_known(const TrackedPose& pose) {
  return pose.state == TrackState::kFixed || pose.state == TrackState::kTracking;
}

struct KeyframePose {
  int number = 0;  ///< of the frame
  double time = 0;
  Rigid3 world_from_camera = Rigid3::Identity();
};

struct TrackerSettings {
  TrackCamera camera;  ///< of the full rectified left image; without a right eye its baseline is
                       ///< arbitrary: 0.08 m
  double disparity_at_infinity_px = 0;
  DepthNoise noise;              ///< of the depth images
  bool adjust_on_thread = true;  ///< false: in track(), at the frame where it is taken over
  bool watch_stillness = true;   ///< false: every frame is tracked in full
  bool adjust = true;            ///< false: no bundle adjustment, to see what it is worth
  bool close_loops = true;       ///< false: drift stays, to see what it is worth
  int most_landmarks = 220;      ///< looked for in a frame
  MapLimits limits;              ///< of what is remembered
};

/// What it has done so far, for benches.
struct TrackerCounts {
  int frames = 0;
  int keyframes = 0;        ///< taken
  int kept_keyframes = 0;   ///< of them remembered
  int lost = 0;             ///< frames
  int stood = 0;            ///< frames that ended with the look whether the camera stands
  int recognised = 0;       ///< times that a lost camera came back
  int loops = 0;            ///< closed, by recognising a keyframe
  int landmarks = 0;        ///< in the map
  double cpu_s = 0;         ///< of track(), its thread's
  double adjust_cpu_s = 0;  ///< of the adjustments, their threads'
};

class Tracker {
 public:
  /// @throws ContractViolation unless focal lengths and baseline are positive and the limits hold
  /// what one frame and its adjustment need
  explicit Tracker(const TrackerSettings& settings);
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;
  ~Tracker();

  /// Frames in their order. Images of another size than the camera's make a lost frame.
  TrackedPose track(const TrackerFrame& frame);

  /// Of all keyframes that are remembered, as adjusted last; for maps that want to follow
  /// corrections.
  [[nodiscard]] std::vector<KeyframePose> keyframes() const;
  [[nodiscard]] TrackerCounts counts() const;
  /// By the last loop that was closed, of the keyframes that were remembered then; empty before.
  /// Valid until the next call of track().
  [[nodiscard]] std::span<const Correction> corrections() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The virtual baseline of colour + depth cameras, m.
inline constexpr double kDepthCameraBaseline = 0.08;

}  // namespace palpable
