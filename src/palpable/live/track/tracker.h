/// @file
/// Tracks the pose of the camera from frame to frame (paper Sec. 3.3: stereo SLAM).
///
/// A landmark is a point of the world, stored with the patch of picture in which it was first seen.
/// In every frame landmarks are searched at the positions that the last motion predicts, first in
/// small images, then in large ones, with their patches warped and smeared by the predicted motion
/// (landmark_search.h). The pose is the one that agrees best with the landmarks found
/// (pose_search.h, pose_fit.h). Some frames are kept as keyframes: a keyframe adds new landmarks
/// (new_landmarks.h), and then the poses and landmarks of the last keyframes are adjusted together
/// (window.h, bundle.h).
///
/// A camera that stands still is detected with a few patches, at next to no cost (still_watch.h).
/// Features are used to find the pose of a lost camera (recogniser.h), and to recognise a known
/// part of the scene when drift is too large to find its landmarks (loop.h). track_states.h draws
/// the states. docs/tracking.md explains the design and lists measured results.
///
/// The world is the camera frame of the first keyframe, m. The same frames give the same poses to
/// the bit, whether adjustments run on a thread of their own or not, because a result is used a
/// fixed number of frames after its work began.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/track/map_limits.h"
#include "palpable/live/track/sighting.h"
#include "palpable/live/track/track_states.h"

#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace palpable {

/// The depth camera's output for one frame. Pointers are used only during the call.
struct TrackerFrame {
  int number = 0;
  double time = 0;                    ///< s, by the source's stamps; rising
  const GrayImage* left = nullptr;    ///< luma, rectified, of TrackCamera's size
  const GrayImage* right = nullptr;   ///< the same for the right camera; null: disparities are
                                      ///< computed from the depth image
  const DepthImage* depth = nullptr;  ///< Z in m of the same view, as large or half as large
  /// 255 where something moves, of the depth's size; or null. Nothing is followed there.
  const MaskImage* moving = nullptr;
};

struct TrackedPose {
  Rigid3 world_from_camera = Rigid3::Identity();
  TrackState state = TrackState::kStarting;
  int landmarks = 0;  ///< landmarks that agreed with the pose; 0 unless kTracking
  int tried = 0;      ///< landmarks that were searched; 0 unless kTracking
  /// Picture shift between the pose that the last motion predicts and the pose that was found, px;
  /// 0 unless kTracking.
  double prediction_error_px = 0;
  bool keyframe = false;  ///< this frame became a keyframe
  /// A loop was closed with this frame. Anything that was placed with earlier poses has their drift
  /// as an error; Tracker::corrections() returns how to correct it.
  bool closed_loop = false;
  /// A new world frame begins with this frame, after the camera was lost for more than a second or
  /// before there was a keyframe. The position in the new world of anything that was placed before
  /// is unknown. The first pose in the new world is the last known pose in the old one.
  bool new_world = false;
  /// s since new_world was last true; infinite if it never was.
  double since_new_world = std::numeric_limits<double>::infinity();
  int newest_keyframe = -1;  ///< its frame number; -1: there is none
  /// This frame's pose relative to the newest keyframe. Combined with a later result of
  /// Tracker::keyframes() it gives this pose with all corrections made in between.
  Rigid3 keyframe_from_camera = Rigid3::Identity();
};

/// Whether the pose of a frame, and so the world position of everything in view, is known.
[[nodiscard]] inline bool is_known(const TrackedPose& pose) {
  return pose.state == TrackState::kFixed || pose.state == TrackState::kTracking;
}

struct KeyframePose {
  int number = 0;   ///< of the frame
  double time = 0;  ///< s, of the frame
  Rigid3 world_from_camera = Rigid3::Identity();
};

struct TrackerSettings {
  TrackCamera camera;  ///< of the full rectified left image; for a colour + depth camera its
                       ///< baseline is kDepthCameraBaseline
  double disparity_at_infinity_px = 0;  ///< disparity of infinitely distant points in the pictures
  DepthNoise noise;                     ///< of the depth images
  bool two_sensors = false;      ///< colour and depth come from two sensors, aligned to some pixels
  bool adjust_on_thread = true;  ///< false: adjustments are made in track(), when they are due
  bool watch_stillness = true;   ///< false: every frame is tracked in full, even if the camera
                                 ///< stands still
  bool adjust = true;            ///< false: no bundle adjustment, to measure its benefit
  bool close_loops = true;       ///< false: no loops are closed, to measure the benefit
  int most_landmarks = 220;      ///< largest number of landmarks that are searched in a frame
  MapLimits limits;              ///< of the map
};

/// Statistics of the tracker since its construction, for benchmarks.
struct TrackerCounts {
  int frames = 0;
  int keyframes = 0;       ///< keyframes made
  int kept_keyframes = 0;  ///< keyframes that are still in the map
  int lost = 0;            ///< frames without a pose
  int stood = 0;           ///< frames that needed only the patches of still_watch.h
  int recognised = 0;      ///< times that a lost camera found its pose again
  int new_worlds = 0;      ///< worlds begun after the camera was lost (TrackedPose::new_world)
  int loops = 0;           ///< loops closed
  int landmarks = 0;       ///< landmarks in the map that are alive
  double disparity_error_px = 0;  ///< that was found in all disparities (disparity_watch.h)
  double cpu_s = 0;               ///< of track(), on the calling thread
  double adjust_cpu_s = 0;        ///< of the background work (keyframe_work.h)
};

class Tracker {
 public:
  /// @throws ContractViolation unless focal lengths and baseline are positive and the limits are
  ///         large enough for one frame and its adjustment
  explicit Tracker(const TrackerSettings& settings);
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;
  ~Tracker();

  /// Finds the pose of the next frame. If the images do not have the camera's size, the state
  /// becomes kLost.
  TrackedPose track(const TrackerFrame& frame);

  /// All keyframes in the map, with their most recently adjusted poses.
  [[nodiscard]] std::vector<KeyframePose> keyframes() const;
  [[nodiscard]] TrackerCounts counts() const;
  /// The corrections by the last closed loop of all keyframes that were then in the map; empty if
  /// no loop was closed. Valid until the next call of track().
  [[nodiscard]] std::span<const Correction> corrections() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// A baseline for colour + depth cameras, m, so that their depths can be treated as disparities.
/// Its value is arbitrary: sigmas of depth are converted with it.
inline constexpr double kDepthCameraBaseline = 0.08;

}  // namespace palpable
