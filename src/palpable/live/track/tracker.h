/// @file
/// Where the camera is, frame after frame (paper Sec. 3.3: stereo SLAM).
///
/// A landmark is a point of the world, kept with the patch of picture in which it was first seen.
/// In every frame landmarks are looked for where the last motion predicts them, first in small
/// images, then in large ones, their patches warped and smeared as the motion says
/// (landmark_search.h). The pose is the one that agrees best with those that are found
/// (pose_search.h, pose_fit.h). Now and then a frame is kept as a keyframe: it brings new landmarks
/// (new_landmarks.h), and poses and landmarks of the last keyframes are adjusted together
/// (window.h, bundle.h).
///
/// A camera that stands still is recognised by a few patches, at next to no cost (still_watch.h). A
/// lost camera is recognised by its features (recogniser.h), and so is known ground to which the
/// camera comes back with too much drift to find its landmarks (loop.h). track_states.h draws the
/// states. docs/tracking.md says why all this is so and how well it does.
///
/// The world is the camera frame of the first keyframe, m. The same frames give the same poses to
/// the bit, whether adjustments run on a thread of their own or not: a result is used a fixed
/// number of frames after it was asked for.
#pragma once

#include "palpable/common/geometry/correction.h"
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

/// What the depth camera has made of one frame. Pointers are read during the call only.
struct TrackerFrame {
  int number = 0;
  double time = 0;                    ///< s, by the source's stamps; rising
  const GrayImage* left = nullptr;    ///< luma, rectified, of TrackCamera's size
  const GrayImage* right = nullptr;   ///< the same of the right eye; null: disparities are computed
                                      ///< from the depth image
  const DepthImage* depth = nullptr;  ///< Z in m of the same view, as large or half as large
  /// 255 where something moves, of the depth's size; or null. Nothing is followed there.
  const MaskImage* moving = nullptr;
};

struct TrackedPose {
  Rigid3 world_from_camera = Rigid3::Identity();
  TrackState state = TrackState::kStarting;
  int landmarks = 0;  ///< that agreed with the pose; 0 unless kTracking
  int tried = 0;      ///< that were looked for; 0 unless kTracking
  /// px by which the picture is not where the last motion predicts it; 0 unless kTracking.
  double prediction_error_px = 0;
  bool keyframe = false;  ///< this frame became a keyframe
  /// A loop was closed with this frame: what was placed by earlier poses may be off by their drift,
  /// and Tracker::corrections() says by how much.
  bool closed_loop = false;
  /// The world begins with this frame, and the camera was lost before: for more than a second, or
  /// without a keyframe. Nobody knows where in the new world that lies which was placed before. Its
  /// first pose is the last one that was known in the old world.
  bool new_world = false;
  /// s since new_world was true last; infinite: it never was.
  double since_new_world = std::numeric_limits<double>::infinity();
  int newest_keyframe = -1;  ///< its frame number; -1: there is none
  /// This frame's pose relative to the newest keyframe. With Tracker::keyframes() it gives the pose
  /// with all corrections that have been made since.
  Rigid3 keyframe_from_camera = Rigid3::Identity();
};

/// Whether the world positions of what a frame shows are known.
[[nodiscard]] inline bool is_known(const TrackedPose& pose) {
  return pose.state == TrackState::kFixed || pose.state == TrackState::kTracking;
}

struct KeyframePose {
  int number = 0;   ///< of the frame
  double time = 0;  ///< s, of the frame
  Rigid3 world_from_camera = Rigid3::Identity();
};

struct TrackerSettings {
  TrackCamera camera;  ///< of the full rectified left image; without a right eye its baseline is
                       ///< kDepthCameraBaseline
  double disparity_at_infinity_px = 0;  ///< that the right image shows of points infinitely far
  DepthNoise noise;                     ///< of the depth images
  bool two_sensors = false;  ///< colour and depth come from two, which agree to some pixels only
  bool adjust_on_thread = true;  ///< false: adjustments are made in track(), when they are due
  bool watch_stillness = true;   ///< false: every frame is tracked in full, also of a camera that
                                 ///< stands
  bool adjust = true;            ///< false: no bundle adjustment, to see what it is worth
  bool close_loops = true;       ///< false: drift stays, to see what closing loops is worth
  int most_landmarks = 220;      ///< that are looked for in a frame
  MapLimits limits;              ///< of what is remembered
};

/// What the tracker has done so far, for benches.
struct TrackerCounts {
  int frames = 0;
  int keyframes = 0;        ///< that were made
  int kept_keyframes = 0;   ///< of them, those that are still remembered
  int lost = 0;             ///< frames without a pose
  int stood = 0;            ///< frames that needed nothing but the patches of still_watch.h
  int recognised = 0;       ///< times that a lost camera found its pose again
  int new_worlds = 0;       ///< that began after the camera was lost (TrackedPose::new_world)
  int loops = 0;            ///< that were closed
  int landmarks = 0;        ///< that are remembered and looked for
  double cpu_s = 0;         ///< of track(), on the calling thread
  double adjust_cpu_s = 0;  ///< of what is done beside the frames (keyframe_work.h)
};

class Tracker {
 public:
  /// @throws ContractViolation unless focal lengths and baseline are positive and the limits hold
  /// what one frame and its adjustment need
  explicit Tracker(const TrackerSettings& settings);
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;
  ~Tracker();

  /// Finds the pose of the next frame. Images of another size than the camera's make it lost.
  TrackedPose track(const TrackerFrame& frame);

  /// All keyframes that are remembered, with their poses as adjusted last.
  [[nodiscard]] std::vector<KeyframePose> keyframes() const;
  [[nodiscard]] TrackerCounts counts() const;
  /// How the last loop that was closed has moved the keyframes that were remembered then; empty
  /// before the first. Valid until the next call of track().
  [[nodiscard]] std::span<const Correction> corrections() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// A baseline for colour + depth cameras, m, so that their depths can be treated as disparities.
/// Its value is arbitrary: sigmas of depth are converted with it.
inline constexpr double kDepthCameraBaseline = 0.08;

}  // namespace palpable
