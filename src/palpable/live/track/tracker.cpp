#include "palpable/live/track/tracker.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/live/track/disparity_watch.h"
#include "palpable/live/track/exposure_estimate.h"
#include "palpable/live/track/forgetting.h"
#include "palpable/live/track/keyframe_work.h"
#include "palpable/live/track/landmark_map.h"
#include "palpable/live/track/loop.h"
#include "palpable/live/track/new_landmarks.h"
#include "palpable/live/track/picture_shift.h"
#include "palpable/live/track/picture_turn.h"
#include "palpable/live/track/pose_search.h"
#include "palpable/live/track/recent_poses.h"
#include "palpable/live/track/start_watch.h"
#include "palpable/live/track/still_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

namespace palpable {
namespace {

// --- following ---------------------------------------------------------------------------------
constexpr int kLeastInliers = 12;  // landmarks that must agree with a pose near the last one
// Landmarks that must agree with the pose of a camera that was lost, and landmarks that the first
// keyframe must have.
constexpr int kLeastRecognisedLost = 20;
constexpr double kSurePx = 2.0;  // largest prediction error after which the coarse search is
                                 // omitted in the next frame
// Share of the searched landmarks below which a pose is doubtful. Where a picture has moved far,
// patches of repeated marks agree by chance with a wrong pose, and its motion would mislead the
// next predictions; so other guesses are tried, and the pose with the most landmarks is used.
constexpr double kDoubtfulShare = 0.3;
constexpr double kMaskedPx = 4.0;  // prediction error above which the moving mask is ignored
constexpr double kFastPx = 14.0;   // px per frame; above, the coarse search is always made and the
                                   // exposure is measured
constexpr double kLongestPrediction = 3;  // largest factor by which the last motion is
                                          // extrapolated after missing frames
// Prediction error when it was not measured, so that the next search is a coarse one.
constexpr double kUnknownError = 1e9;  // px

// --- standing still ----------------------------------------------------------------------------
// px; if a pose is found that differs less from the pose at rest, the camera still stands, and its
// patches are hidden by a hand.
constexpr double kSamePosePx = 2 * RecentPoses::kRestPx;
constexpr double kLongestHidden = 1;  // s during which a camera at rest may see too little
// s after which a lost camera begins a new world. If it is too short, a brief look away from the
// mapped part of the scene discards the map.
constexpr double kLongestLost = 1;

// --- keyframes ---------------------------------------------------------------------------------
constexpr int kLatency = 3;  // frames after which the work of a keyframe is used
// Smallest number of frames between keyframes, larger than the latency. kHurriedGap applies if the
// camera has few inliers left; the new keyframe then waits for the work of the one before.
constexpr int kKeyframeGap = 4;
constexpr int kHurriedGap = 2;
constexpr int kMust = 35;  // inliers; with fewer a frame becomes a keyframe even if it is blurred
constexpr int kFew = 70;   // inliers; with fewer it becomes one after kHurriedGap frames
constexpr double kFewer = 0.7;  // share of the last keyframe's landmarks; with fewer inliers it
                                // becomes one
// It also becomes one if every keyframe is farther away than kFarMoved times the median depth, or
// turned by more than kTurned rad.
constexpr double kFarMoved = 0.12;
constexpr double kTurned = 0.2;
// Frames between attempts to make the first keyframe; a camera that moves tries in every frame.
constexpr int kStartEvery = 5;

// --- recognition -------------------------------------------------------------------------------
// Number of keyframes with the most similar pictures whose features are compared with those of a
// lost camera. One more keyframe is compared in turn, so that all of them are tried eventually.
constexpr int kMostAlike = 3;

Rigid3 inverse(const Rigid3& T) { return T.inverse(Eigen::Isometry); }

// Indices of all keyframes, in falling order of similarity to a picture.
std::vector<int> by_likeness(const Thumbnail& picture, const std::vector<Keyframe>& keyframes) {
  std::vector<int> order(keyframes.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> alike(keyframes.size());
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    alike[k] = likeness(picture, keyframes[k].thumbnail);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return alike[a] > alike[b]; });
  return order;
}

}  // namespace

struct Tracker::Parts {
  explicit Parts(const TrackerSettings& s)
      : settings(s), camera(s.camera), pose_search(s), start_watch(s.noise) {
    map.landmarks.reserve(s.limits.landmarks);
    map.keyframes.reserve(s.limits.keyframes + 1);
    depths.reserve(s.most_landmarks);
  }

  // --- one frame ---
  TrackedPose track(const TrackerFrame& frame);
  [[nodiscard]] bool fits(const TrackerFrame& frame) const;
  bool begin_world(const TrackerFrame& frame);
  bool begin_anew(const TrackerFrame& frame);
  [[nodiscard]] FrameEvidence begun() const {
    return settings.watch_stillness ? FrameEvidence::kFirstKeyframe : FrameEvidence::kPoseFound;
  }
  FrameEvidence follow(const TrackerFrame& frame, double dt);
  bool follow_motion(const TrackerFrame& frame, double dt);
  bool recognise_place(const TrackerFrame& frame);
  std::optional<Rigid3> find_near(const TrackerFrame& frame, const Rigid3& guess, bool coarse_first,
                                  int least);
  bool locate(const TrackerFrame& frame, const Rigid3& guess, bool coarse_first, int least);
  void use_found(const Rigid3& guess, const Rigid3& found);
  [[nodiscard]] std::optional<Rigid3> turned_pose();
  FrameEvidence use_pose(const TrackerFrame& frame, double dt, bool followed);

  // --- its keyframe, and the background work ---
  [[nodiscard]] bool wants_keyframe() const;
  void keep(const TrackerFrame& frame);
  void use_finished_work();

  [[nodiscard]] LandmarkSearch search() const { return {settings, pyramid, map}; }
  [[nodiscard]] double shift_px(const Rigid3& a_from_world, const Rigid3& b_from_world) const {
    return picture_shift_px(camera, median_depth, a_from_world, b_from_world);
  }

  TrackerSettings settings;
  TrackCamera camera;
  TrackState state = TrackState::kStarting;
  LandmarkMap map;
  LandmarkMap other_map;  // the old map during begin_anew(), otherwise empty

  // The camera.
  Rigid3 camera_from_world = Rigid3::Identity();
  Rigid3 previous_from_world = Rigid3::Identity();   // camera_from_world one frame ago
  Rigid3 camera_from_previous = Rigid3::Identity();  // the last motion
  double motion_time = 0;                            // s, duration of that motion; 0: there is none
  double last_time = 0;                              // s
  std::optional<double> new_world_time;              // s, when the last new world began
  double median_depth = 1;                           // m, of the landmarks that agreed
  double prediction_error_px = kUnknownError;        // of the last prediction

  // Following the camera.
  Pyramid pyramid;
  PoseSearch pose_search;
  PictureTurn picture_turn;  // since the last frame whose pose is known
  ExposureEstimate exposure;
  std::vector<double> depths;  // work space

  // Detecting a camera that stands still.
  StartWatch start_watch;  // before the first keyframe
  StillWatch still_watch;  // the view in which it came to rest
  RecentPoses recent_poses;
  double hidden_s = 0;  // s during which too little could be compared with that view
  double lost_s = 0;    // s for which the camera has been lost

  // Keyframes, and the background work.
  NewLandmarks new_landmarks;
  int since_keyframe = 0;  // frames
  KeyframeWorker worker;
  int work_due = 0;       // frame count at which its result is used
  int next_compared = 0;  // keyframe with which a lost camera is compared, in turn
  DisparityWatch disparity_watch;
  LoopConfirmation loops;
  std::vector<Correction> corrections;  // by the last closed loop
  TrackerCounts counts;
};

// --- one frame ---------------------------------------------------------------------------------

TrackedPose Tracker::Parts::track(const TrackerFrame& frame) {
  const CpuTimer timer(counts.cpu_s);
  const int loops_before = counts.loops, keyframes_before = counts.keyframes;
  ++counts.frames;
  ++since_keyframe;
  const double dt = std::max(frame.time - last_time, 1e-3);
  last_time = frame.time;
  if (worker.is_busy() && counts.frames >= work_due) use_finished_work();

  TrackedPose result;
  if (!fits(frame)) {
    state = next_state(state, FrameEvidence::kUnreadable);
  } else if (map.keyframes.empty()) {
    const bool stands = start_watch.look(*frame.left, *frame.depth) == Stillness::kStill;
    state = next_state(state, stands ? FrameEvidence::kStartView : FrameEvidence::kOtherView);
    if ((!stands || counts.frames % kStartEvery == 1) && begin_world(frame)) {
      result.new_world = state == TrackState::kLost;
      state = next_state(state, begun());
    }
  } else {
    state = next_state(state, follow(frame, dt));
    lost_s = state == TrackState::kLost ? lost_s + dt : 0;
    if (lost_s > kLongestLost && begin_anew(frame)) {
      result.new_world = true;
      state = next_state(state, begun());
    }
  }

  if (state == TrackState::kLost) ++counts.lost;
  if (result.new_world) {
    ++counts.new_worlds;
    new_world_time = frame.time;
  }
  if (new_world_time) result.since_new_world = frame.time - *new_world_time;
  // The inverse of the identity would have minus zeros.
  if (!camera_from_world.matrix().isIdentity(0)) {
    result.world_from_camera = inverse(camera_from_world);
  }
  result.state = state;
  if (state == TrackState::kTracking) {
    result.prediction_error_px = prediction_error_px;
    result.landmarks = pose_search.inliers();
    result.tried = pose_search.tried();
  }
  result.keyframe = counts.keyframes > keyframes_before;
  result.closed_loop = counts.loops > loops_before;
  if (!map.keyframes.empty()) {
    const Keyframe& newest = map.keyframes.back();
    result.newest_keyframe = newest.number;
    result.keyframe_from_camera = newest.camera_from_world * result.world_from_camera;
  }
  return result;
}

bool Tracker::Parts::fits(const TrackerFrame& frame) const {
  const auto has_size = [&](const GrayImage* image) {
    return image == nullptr ||
           (image->width() == camera.camera.width && image->height() == camera.camera.height);
  };
  return frame.left != nullptr && frame.depth != nullptr && !frame.depth->empty() &&
         has_size(frame.left) && has_size(frame.right);
}

// Makes the first keyframe. False if the frame has too few landmarks to find the camera again.
bool Tracker::Parts::begin_world(const TrackerFrame& frame) {
  pyramid.build(*frame.left);
  picture_turn.keep(pyramid.level(3));
  pose_search.clear();
  loops.clear();
  keep(frame);
  if (map.keyframes.back().tracked < kLeastRecognisedLost) {
    map.clear();
    worker.abandon();
    --counts.keyframes;
    return false;
  }
  if (settings.watch_stillness) still_watch.begin(*frame.left, *frame.depth);
  return true;
}

// Replaces a world in which the camera was not found by a new one, which begins at the last known
// pose. False if the frame has too few landmarks; the old world is kept then.
bool Tracker::Parts::begin_anew(const TrackerFrame& frame) {
  if (worker.is_busy()) use_finished_work();
  std::swap(map, other_map);
  if (!begin_world(frame)) {
    std::swap(map, other_map);
    return false;
  }
  other_map.clear();
  corrections.clear();
  exposure = {};
  previous_from_world = camera_from_world;
  camera_from_previous = Rigid3::Identity();
  motion_time = 0;
  prediction_error_px = kUnknownError;
  recent_poses.clear();
  hidden_s = lost_s = 0;
  return true;
}

// Determines the evidence of a frame when there is a world, and updates the pose.
FrameEvidence Tracker::Parts::follow(const TrackerFrame& given, double dt) {
  TrackerFrame frame = given;
  const bool was_fixed = state == TrackState::kFixed;
  // A moving camera is not compared with the view in which it last stood still.
  if (settings.watch_stillness && still_watch.begun() && state != TrackState::kTracking) {
    const Stillness seen = still_watch.look(*frame.left, *frame.depth, frame.moving);
    if (seen == Stillness::kStill) {
      hidden_s = 0;
      ++counts.stood;
      return FrameEvidence::kPatchesAtRest;
    }
    if (seen == Stillness::kUnclear && was_fixed) hidden_s += dt;
  }
  pyramid.build(*frame.left);
  // A camera that was covered or is in the dark need not have moved. For a while no other pose is
  // searched for it, because landmarks found in the dark are found by chance.
  const bool may_be_hidden = was_fixed && hidden_s > 0 && hidden_s < kLongestHidden;
  const Rigid3 held = camera_from_world;
  const bool was_lost = state == TrackState::kLost;
  // The moving mask was computed with a predicted pose. If the last prediction was bad, the mask
  // contains mostly static things that were predicted wrongly, and is ignored. If no pose is found
  // with the mask, the same may be the case, and the search is repeated without it.
  if (prediction_error_px > kMaskedPx) frame.moving = nullptr;
  bool followed = !was_lost && follow_motion(frame, dt);
  if (!followed && !was_lost && std::exchange(frame.moving, nullptr) != nullptr) {
    followed = follow_motion(frame, dt);
  }
  if (!followed && may_be_hidden) return FrameEvidence::kHidden;
  if (!followed && !recognise_place(frame)) {
    camera_from_previous = Rigid3::Identity();
    recent_poses.clear();
    return FrameEvidence::kNoPose;
  }
  picture_turn.keep(pyramid.level(3));
  hidden_s = 0;
  if (was_fixed && shift_px(held, camera_from_world) < kSamePosePx) {
    camera_from_world = previous_from_world = held;
    return FrameEvidence::kPoseAtRest;
  }
  // The pose was known before and was found by features: that gives the motion.
  if (!followed && !was_lost) previous_from_world = held;
  return use_pose(frame, dt, !was_lost);
}

// Finds the pose near the one that the last motion predicts, or else near the last pose, or near
// that one turned as the whole picture has moved.
bool Tracker::Parts::follow_motion(const TrackerFrame& frame, double dt) {
  const double share = motion_time > 0 ? std::clamp(dt / motion_time, 0.0, kLongestPrediction) : 0;
  const Rigid3 predicted =
      moved_by(Twist::Zero(), part_of(camera_from_previous, share) * camera_from_world);
  const bool sure =
      prediction_error_px < kSurePx && shift_px(camera_from_world, predicted) < kFastPx;
  if (sure && locate(frame, predicted, false, 2 * kLeastInliers)) return true;
  std::optional<Rigid3> best, found;  // the guess that led to the most landmarks, and its pose
  int most = 0;
  bool is_last = false;  // whether pose_search holds the result of the best guess
  for (int n = 0; n < 3 && most <= kDoubtfulShare * pose_search.tried(); ++n) {
    const std::optional<Rigid3> guess = n == 0   ? predicted
                                        : n == 1 ? camera_from_world
                                                 : turned_pose();
    if (!guess) continue;
    const auto pose = find_near(frame, *guess, true, std::max(kLeastInliers, most + 1));
    is_last = pose.has_value();
    if (!pose) continue;
    best = guess;
    found = pose;
    most = pose_search.inliers();
  }
  if (!best) return false;
  if (!is_last) return locate(frame, *best, true, kLeastInliers);
  use_found(*best, *found);
  return true;
}

// The last pose, turned so that the whole picture moves as it has moved since then.
std::optional<Rigid3> Tracker::Parts::turned_pose() {
  const std::optional<Eigen::Matrix3d> turn = picture_turn.turn_to(pyramid.level(3), camera.camera);
  if (!turn) return std::nullopt;
  Rigid3 now_from_then = Rigid3::Identity();
  now_from_then.linear() = *turn;
  return moved_by(Twist::Zero(), now_from_then * camera_from_world);
}

// Finds the pose of a camera that was lost: near the last pose, near the keyframe with the most
// similar picture, or by the features of some keyframes.
bool Tracker::Parts::recognise_place(const TrackerFrame& frame) {
  if (worker.is_busy()) use_finished_work();  // so that the last keyframe can be recognised too
  const std::vector<int> order = by_likeness(thumbnail_of(pyramid.level(2)), map.keyframes);
  const Rigid3 held = camera_from_world;
  const auto try_near = [&](const Rigid3& pose) {
    camera_from_world = pose;  // no motion, no smear
    if (locate(frame, pose, true, kLeastRecognisedLost)) {
      if (state == TrackState::kLost) ++counts.recognised;
      return true;
    }
    camera_from_world = held;
    return false;
  };
  if (try_near(held) || try_near(map.keyframes[order.front()].camera_from_world)) return true;
  if (const auto turned = turned_pose(); turned && try_near(*turned)) return true;

  const PinholeCamera half = camera.camera.scaled_down(2);
  const Features features = find_features(pyramid.level(1), half, *frame.depth);
  if (features.uv.empty()) return false;
  std::vector<int> compared(
      order.begin(), order.begin() + std::min<std::ptrdiff_t>(kMostAlike, std::ssize(order)));
  // If the pose was known in the frame before, the camera is probably near the newest keyframe.
  if (state != TrackState::kLost)
    compared.insert(compared.begin(), static_cast<int>(map.keyframes.size()) - 1);
  next_compared = (next_compared + 1) % static_cast<int>(map.keyframes.size());
  compared.push_back(next_compared);
  for (const int k : compared) {
    const Keyframe& keyframe = map.keyframes[k];
    const std::optional<Recognised> seen = recognise(features, keyframe.features, half);
    if (seen && try_near(seen->camera_from_old * keyframe.camera_from_world)) return true;
  }
  return false;
}

// Finds a pose near `guess`; the camera's pose does not change.
std::optional<Rigid3> Tracker::Parts::find_near(const TrackerFrame& frame, const Rigid3& guess,
                                                bool coarse_first, int least) {
  return pose_search.find(search(), frame,
                          {.guess = guess,
                           .previous = camera_from_world,
                           .coarse_first = coarse_first,
                           .least_inliers = least,
                           .exposure = exposure.share(),
                           .frame_count = counts.frames});
}

// Finds a pose near `guess` and makes it the camera's; false if there is none.
bool Tracker::Parts::locate(const TrackerFrame& frame, const Rigid3& guess, bool coarse_first,
                            int least) {
  const std::optional<Rigid3> found = find_near(frame, guess, coarse_first, least);
  if (!found) return false;
  use_found(guess, *found);
  return true;
}

// Makes a pose that was found from `guess` the camera's.
void Tracker::Parts::use_found(const Rigid3& guess, const Rigid3& found) {
  prediction_error_px = shift_px(guess, found);
  previous_from_world = camera_from_world;
  camera_from_world = found;
}

// Uses a pose that was found: updates motion, median depth, exposure and landmarks, keeps the frame
// as a keyframe if needed, and detects a camera that has come to rest.
// @param followed  whether the pose of the frame before was known
FrameEvidence Tracker::Parts::use_pose(const TrackerFrame& frame, double dt, bool followed) {
  camera_from_previous =
      followed ? Rigid3(camera_from_world * inverse(previous_from_world)) : Rigid3::Identity();
  motion_time = dt;
  if (!followed) prediction_error_px = kUnknownError;
  still_watch = {};  // the camera has left the view in which it stood
  depths.clear();
  pose_search.for_each_inlier([&](const Candidate&, const PosePoint& point) {
    depths.push_back((camera_from_world * point.x_in_world).z());
  });
  if (!depths.empty()) median_depth = upper_median(depths);
  if (followed && shift_px(previous_from_world, camera_from_world) > kFastPx) {
    exposure.measure(search(), pose_search, camera_from_world, previous_from_world, counts.frames);
  }
  pose_search.rate_landmarks(map.landmarks, counts.frames);
  if (wants_keyframe()) keep(frame);
  if (!settings.watch_stillness ||
      !recent_poses.add_and_check_rest(camera, median_depth, frame.time, camera_from_world)) {
    return FrameEvidence::kPoseFound;
  }
  still_watch.begin(*frame.left, *frame.depth);
  camera_from_previous = Rigid3::Identity();
  recent_poses.clear();
  return FrameEvidence::kCameToRest;
}

// --- keyframes ---------------------------------------------------------------------------------

bool Tracker::Parts::wants_keyframe() const {
  const Rigid3 world_from_camera = inverse(camera_from_world);
  const auto is_near = [&](const Keyframe& keyframe) {
    const Rigid3 keyframe_from_camera = keyframe.camera_from_world * world_from_camera;
    const double angle = Eigen::AngleAxisd(keyframe_from_camera.linear()).angle();
    return keyframe_from_camera.translation().norm() < kFarMoved * median_depth && angle < kTurned;
  };
  // If the camera has not moved far yet, its inliers are few for another reason, for instance a
  // slow error of the depths, and another keyframe would not help.
  if (since_keyframe < kKeyframeGap && is_near(map.keyframes.back())) return false;
  const int inliers = pose_search.inliers();
  if (inliers < kMust) return true;
  if (pose_search.is_blurred()) return false;
  const bool fewer = inliers < kFewer * map.keyframes.back().tracked;
  if (inliers < kFew && (fewer || since_keyframe >= kHurriedGap)) return true;
  if (since_keyframe < kKeyframeGap) return false;
  if (fewer) return true;
  return std::none_of(map.keyframes.begin(), map.keyframes.end(), is_near);
}

// Makes this frame a keyframe, and begins its background work.
void Tracker::Parts::keep(const TrackerFrame& frame) {
  if (worker.is_busy()) use_finished_work();
  Keyframe keyframe;
  keyframe.number = frame.number;
  keyframe.time = frame.time;
  keyframe.camera_from_world = camera_from_world;
  keyframe.thumbnail = thumbnail_of(pyramid.level(2));
  const int index = static_cast<int>(map.keyframes.size());
  pose_search.for_each_inlier([&](const Candidate& candidate, const PosePoint& point) {
    map.landmarks[candidate.landmark].sightings.push_back({index, point.seen});
    keyframe.landmarks.push_back(candidate.landmark);
  });
  map.keyframes.push_back(std::move(keyframe));
  if (std::ssize(map.keyframes) > settings.limits.keyframes ||
      map.room_for_landmarks(settings.limits.landmarks) < settings.most_landmarks + kNewLandmarks) {
    make_room(camera_from_world, settings.limits, kWindow, map);
  }
  new_landmarks.add(search(), frame, pose_search, counts.frames, map);
  Keyframe& kept = map.keyframes.back();
  kept.tracked = static_cast<int>(kept.landmarks.size());
  std::vector<double> seen_depths;
  for (const int id : kept.landmarks) {
    seen_depths.push_back((kept.camera_from_world * map.landmarks[id].x_in_world).z());
  }
  if (!seen_depths.empty()) median_depth = kept.median_depth = upper_median(seen_depths);
  since_keyframe = 0;
  ++counts.keyframes;
  const auto watch =
      frame.right != nullptr ? std::optional(disparity_watch) : std::optional<DisparityWatch>();
  worker.begin(
      work_for_newest(settings, map, pyramid.level(1), *frame.depth, loops.take_confirmed(), watch),
      settings.adjust_on_thread);
  work_due = counts.frames + kLatency;
}

// Writes the result of the background work into the map, and corrects the camera's pose with it.
void Tracker::Parts::use_finished_work() {
  KeyframeWork work = worker.finish();
  counts.adjust_cpu_s += work.cpu_s;
  counts.cpu_s -= work.cpu_s_of_caller;

  Keyframe& newest = map.keyframes.back();
  newest.features = std::move(work.features);
  const Rigid3 newest_from_old_world = newest.camera_from_world;
  if (work.window) {
    put_back(*work.window, map);
    settings.camera = camera = work.window->problem.camera;  // with its disparity error
    disparity_watch = work.window->watch.value_or(disparity_watch);
  }
  if (work.graph && work.graph_is_solved) {
    corrections = close_loop(camera, *work.closing, *work.graph, map);
    prediction_error_px = kUnknownError;  // makes the next search for old landmarks a coarse one
    ++counts.loops;
  }
  // The camera's pose relative to the newest keyframe does not change.
  const Rigid3 old_world_from_world = inverse(newest_from_old_world) * newest.camera_from_world;
  camera_from_world = moved_by(Twist::Zero(), camera_from_world * old_world_from_world);
  previous_from_world = moved_by(Twist::Zero(), previous_from_world * old_world_from_world);
  recent_poses.move_world(old_world_from_world);
  if (settings.close_loops) loops.compare(work.loop, camera, median_depth, map.keyframes);
}

// --- the interface -----------------------------------------------------------------------------

Tracker::Tracker(const TrackerSettings& settings) : parts_(std::make_unique<Parts>(settings)) {
  PALPABLE_EXPECT(settings.camera.camera.fx_px > 0 && settings.camera.camera.fy_px > 0 &&
                      settings.camera.baseline > 0,
                  "focal lengths and baseline are positive");
  PALPABLE_EXPECT(settings.limits.keyframes >= 2 * kWindow &&
                      settings.limits.landmarks >= 2 * (settings.most_landmarks + kNewLandmarks),
                  "the limits allow at least 14 keyframes and the landmarks of two frames");
}
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;
Tracker::~Tracker() = default;

TrackedPose Tracker::track(const TrackerFrame& frame) { return parts_->track(frame); }

std::vector<KeyframePose> Tracker::keyframes() const {
  std::vector<KeyframePose> poses;
  for (const Keyframe& k : parts_->map.keyframes) {
    poses.push_back({k.number, k.time, inverse(k.camera_from_world)});
  }
  return poses;
}

std::span<const Correction> Tracker::corrections() const { return parts_->corrections; }

TrackerCounts Tracker::counts() const {
  TrackerCounts counts = parts_->counts;
  counts.kept_keyframes = static_cast<int>(parts_->map.keyframes.size());
  counts.landmarks = parts_->map.count_alive();
  counts.disparity_error_px = parts_->camera.disparity_error_px;
  return counts;
}

}  // namespace palpable
