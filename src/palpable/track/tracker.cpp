#include "palpable/track/tracker.h"

#include "palpable/base/contract.h"
#include "palpable/base/cpu_time.h"
#include "palpable/base/order_statistics.h"
#include "palpable/track/forgetting.h"
#include "palpable/track/landmark_map.h"
#include "palpable/track/landmark_search.h"
#include "palpable/track/loop.h"
#include "palpable/track/new_corners.h"
#include "palpable/track/pose_fit.h"
#include "palpable/track/pose_graph.h"
#include "palpable/track/start_watch.h"
#include "palpable/track/still_watch.h"
#include "palpable/track/window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <future>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

// --- what is looked for ------------------------------------------------------------------------
constexpr int kCoarseCells = 8;  // and up to three in each of these for the first guess
constexpr int kCoarse = 64;      // landmarks of the first guess

// --- how well it has to fit --------------------------------------------------------------------
constexpr double kCoarseLikeness = 0.6;
constexpr double kFineLikeness = 0.7;
constexpr int kLeastInliers = 12;
constexpr int kLeastRecognised = 20;
constexpr double kLeastAgreeing = 0.4;  // of those found
constexpr double kSurePx = 2.0;         // a prediction that was better needs no first guess

// --- smear -------------------------------------------------------------------------------------
constexpr double kSmearPerLevel = 3.0;  // px: a level is left out where it is smeared farther
constexpr double kFastPx = 14.0;        // px per frame from which the exposure is estimated
constexpr std::array kExposures{0.0, 0.12, 0.24, 0.36, 0.5, 0.7};  // shares of the frame time

// --- keyframes ---------------------------------------------------------------------------------
constexpr int kLatency = 3;         // frames after which an adjustment is taken over
constexpr int kKeyframeGap = 4;     // frames; more than the latency
constexpr double kFewer = 0.7;      // of the landmarks that carried the last keyframe
constexpr int kFew = 70;            // landmarks
constexpr double kFarMoved = 0.12;  // of the median depth, from every keyframe
constexpr double kTurned = 0.2;     // rad
constexpr double kBlurredPx = 4;    // a smeared frame is kept only when it must be
constexpr int kMust = 35;
constexpr int kStartEvery = 5;     // frames, until one shows enough
constexpr int kNewLandmarks = 60;  // of a keyframe, more than are looked for in a frame
// A corner this near to where an older landmark is expected, px, and as deep, is the same place.
constexpr double kSamePlace = 2;
constexpr double kSameDepth = 3;  // sigmas of d

// --- loops -------------------------------------------------------------------------------------
constexpr int kLoopCandidates = 2;  // keyframes that a new one is compared with
// Off by less, old landmarks are found by themselves (up to 48 px); off by more a loop is closed.
constexpr double kLoopPx = 20;

// --- standing still ----------------------------------------------------------------------------
constexpr double kStillSeconds = 0.7;
constexpr double kStillPx = 0.2;
constexpr std::size_t kMoments = 128;  // frames in that time, of a camera of 120 a second

Rigid3 inverse(const Rigid3& T) { return T.inverse(Eigen::Isometry); }

// What is worked out beside the frames after each keyframe, and what comes back.
struct Work {
  std::optional<Window> window;
  std::optional<PoseGraph> graph;  // instead of the window, when a loop is closed:
  std::optional<Loop> closing;     // this one
  GrayImage image;                 // of the newest keyframe, for its features
  PinholeCamera image_camera;
  DepthImage depth;
  std::vector<std::pair<int, Features>> asked;  // frame numbers of keyframes that it may show again
  int number = 0;                               // of the newest keyframe

  Features features;
  bool closed = false;       // the graph was solved
  std::optional<Loop> loop;  // the best that was found
  double cpu_s = 0;
};

Work worked_out(Work work) {
  double cpu = 0;
  {
    const CpuTimer timer(cpu);
    if (work.window) adjust(*work.window);
    if (work.graph) work.closed = adjust_pose_graph(*work.graph).solved;
    work.features = find_features(work.image, work.image_camera, work.depth);
    for (const auto& [number, known] : work.asked) {
      const std::optional<Recognised> seen = recognise(work.features, known, work.image_camera);
      if (!seen || seen->agreeing < kLeastRecognised) continue;
      if (work.loop && seen->agreeing <= work.loop->new_from_old.agreeing) continue;
      work.loop = Loop{number, work.number, *seen};
    }
  }
  work.cpu_s = cpu;
  return work;
}

}  // namespace

struct Tracker::Parts {
  explicit Parts(const TrackerSettings& s) : settings(s), camera(s.camera), start_watch(s.noise) {
    landmarks.reserve(static_cast<std::size_t>(s.limits.landmarks));
    keyframes.reserve(static_cast<std::size_t>(s.limits.keyframes) + 1);
    points.reserve(static_cast<std::size_t>(s.most_landmarks));
    point_candidate.reserve(points.capacity());
    fit.inlier.reserve(points.capacity());
    numbers.reserve(points.capacity());
    // As many as there are cells, before the best are left: a picture is not higher than wide.
    candidates.reserve(LandmarkSearch::kCellsAcross * LandmarkSearch::kCellsAcross);
    was_found.reserve(candidates.capacity());
    cells.reserve(candidates.capacity());
    history.reserve(kMoments);
  }

  // --- one frame ---
  TrackedPose track(const TrackerFrame& frame);
  void start(const TrackerFrame& frame);
  bool follow_motion(const TrackerFrame& frame, double dt);
  bool come_back(const TrackerFrame& frame);
  bool locate(const TrackerFrame& frame, const Rigid3& guess, bool first_guess, int least);
  void accept(const TrackerFrame& frame, double dt);

  // --- its steps ---
  [[nodiscard]] LandmarkSearch search() const { return {settings, pyramid, keyframes, landmarks}; }
  void select(const TrackerFrame& frame, const Rigid3& pose, const Rigid3& before);
  bool guess_from_coarse(const TrackerFrame& frame, Rigid3& pose);
  void find_all(const TrackerFrame& frame);
  void learn_exposure();
  void rate_landmarks(int frame);
  [[nodiscard]] bool wants_keyframe() const;
  void keep(const TrackerFrame& frame);
  void find_unfound(const TrackerFrame& frame);
  bool is_older(const TrackerFrame& frame, const Eigen::Vector3d& uvd, Keyframe& keyframe);
  void add_corners(const TrackerFrame& frame, Keyframe& keyframe);
  void remember(Landmark landmark, Keyframe& keyframe);
  void ask_for_work(const TrackerFrame& frame);
  void take_over();
  void consider(const std::optional<Loop>& loop);
  void watch_for_standstill(const TrackerFrame& frame);
  double shift_px(const Rigid3& a, const Rigid3& b) const;

  TrackerSettings settings;
  TrackCamera camera;
  Pyramid pyramid;

  std::vector<Keyframe> keyframes;
  std::vector<Landmark> landmarks;
  std::vector<int> free_slots;  // of landmarks

  TrackState state = TrackState::kStarting;
  Rigid3 camera_from_world = Rigid3::Identity();
  Rigid3 previous = Rigid3::Identity();  // camera_from_world one frame ago
  Rigid3 step = Rigid3::Identity();      // camera_now from camera_before
  double step_time = 0;                  // s
  double last_time = 0;
  int last_number = -1;
  double error_px = 1e9;  // of the last prediction
  double smear_px = 0;    // median of this frame
  double exposure = 0;    // share of the frame time that the shutter is open
  bool exposure_known = false;
  double median_depth = 1;
  int since_keyframe = 0;
  double fixed_unclear_s = 0;

  std::vector<Candidate> candidates;
  std::vector<Candidate>
      unfound;  // of a keyframe: all that should be seen in it and were not found
  std::vector<PosePoint> points;
  std::vector<int> point_candidate;  // of points
  PoseFit fit;
  int tried = 0;

  StartWatch start_watch;  // until something can be followed
  StillWatch watch;
  struct Moment {
    double time;
    Rigid3 camera_from_world;
  };
  std::vector<Moment> history;

  // Room to work in, so that a frame takes no memory.
  std::vector<double> numbers;
  std::vector<char> was_found;  // of candidates
  std::vector<int> cells;

  std::optional<std::future<Work>> pending;
  bool deferred = false;  // it is worked out on this thread, by take_over
  int pending_due = 0;
  int next_asked = 0;                 // keyframe that a lost camera is compared with, in turn
  std::optional<Rigid3> loop_change;  // drifted world from world, by the last keyframe's loop
  std::optional<Loop> confirmed;      // two keyframes in turn agree on it
  std::vector<Correction> corrections;
  TrackerCounts counts;
};

// --- one pose ----------------------------------------------------------------------------------

// What should be seen from `pose`, and how far it is smeared when the image moved from `before`.
void Tracker::Parts::select(const TrackerFrame& frame, const Rigid3& pose, const Rigid3& before) {
  search().select(frame, pose, before, exposure, counts.frames, cells, candidates);
  numbers.clear();
  for (const Candidate& candidate : candidates) numbers.push_back(candidate.smear.norm());
  smear_px = numbers.empty() ? 0 : upper_median(numbers);
}

// The pose from few landmarks in small images, for when the prediction may be far off.
bool Tracker::Parts::guess_from_coarse(const TrackerFrame& frame, Rigid3& pose) {
  select(frame, pose, camera_from_world);
  // The best first, no more than three of a large cell.
  std::array<int, static_cast<std::size_t>(kCoarseCells * kCoarseCells)> used{};
  points.clear();
  for (const Candidate& candidate : candidates) {
    if (points.size() >= kCoarse) break;
    const int cx = std::min(static_cast<int>(candidate.uv.x()) * kCoarseCells / camera.camera.width,
                            kCoarseCells - 1);
    const int cy = std::min(
        static_cast<int>(candidate.uv.y()) * kCoarseCells / camera.camera.height, kCoarseCells - 1);
    int& count = used[static_cast<std::size_t>(cy * kCoarseCells + cx)];
    if (count >= 3) continue;
    ++count;
    Eigen::Vector2d uv;
    int level = 0;
    if (!search().find(candidate, 3, 2, kCoarseLikeness, uv, level)) continue;
    const Landmark& landmark = landmarks[static_cast<std::size_t>(candidate.landmark)];
    PosePoint point;
    point.x_in_world = landmark.x_in_world;
    point.seen.uvd = {uv.x(), uv.y(), std::numeric_limits<double>::quiet_NaN()};
    point.seen.sigma = 0.2 * (1 << level);
    point.trust = (landmark.inlier + 1.0) / (landmark.inlier + 2.0 * landmark.outlier + 1.0);
    points.push_back(point);
  }
  if (points.size() < 8) return false;
  fit_pose(camera, points, pose, {.tukey = 4, .first_width = 16, .steps = 12}, fit);
  if (!fit.solved || fit.inliers < 7) return false;
  pose = fit.camera_from_world;
  return true;
}

void Tracker::Parts::find_all(const TrackerFrame& frame) {
  int finest = 0;
  while (finest < 2 && smear_px > kSmearPerLevel * (1 << finest)) ++finest;
  points.clear();
  point_candidate.clear();
  tried = static_cast<int>(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& candidate = candidates[i];
    Eigen::Vector2d uv;
    int level = 0;
    if (!search().find(candidate, finest + 1, finest, kFineLikeness, uv, level)) continue;
    const Landmark& landmark = landmarks[static_cast<std::size_t>(candidate.landmark)];
    PosePoint point;
    point.x_in_world = landmark.x_in_world;
    point.seen = search().sighting_of(frame, candidate, uv, level);
    // One that has held still for long is believed more than one that is new.
    const double age = std::min(1.0, landmark.inlier / 15.0);
    point.trust = (0.4 + 0.6 * age) * (landmark.inlier + 1.0) /
                  (landmark.inlier + 2.0 * landmark.outlier + 1.0);
    points.push_back(point);
    point_candidate.push_back(static_cast<int>(i));
  }
}

// The pose near `guess`; the camera's own is changed only when it is found.
bool Tracker::Parts::locate(const TrackerFrame& frame, const Rigid3& guess, bool first_guess,
                            int least) {
  Rigid3 pose = guess;
  if (first_guess && !guess_from_coarse(frame, pose)) return false;
  select(frame, pose, camera_from_world);
  find_all(frame);
  if (static_cast<int>(points.size()) < least) return false;
  fit_pose(camera, points, pose, {.tukey = 5, .first_width = 4, .steps = 12}, fit);
  if (!fit.solved || fit.inliers < least ||
      fit.inliers < kLeastAgreeing * static_cast<double>(points.size())) {
    return false;
  }
  error_px = shift_px(guess, fit.camera_from_world);
  previous = camera_from_world;
  camera_from_world = fit.camera_from_world;
  return true;
}

// How far the middle and the quarters of the picture move between two poses, px.
double Tracker::Parts::shift_px(const Rigid3& a, const Rigid3& b) const {
  const Rigid3 b_from_a = b * inverse(a);
  double most = 0;
  for (const auto& [u, v] : {std::pair{0.5, 0.5}, {0.2, 0.2}, {0.8, 0.2}, {0.2, 0.8}, {0.8, 0.8}}) {
    const Eigen::Vector2d uv(u * camera.camera.width, v * camera.camera.height);
    const Eigen::Vector3d x = b_from_a * camera.camera.unproject(uv.x(), uv.y(), median_depth);
    if (x.z() < LandmarkSearch::kNearest) return 1e9;
    most = std::max(most, (camera.camera.project(x) - uv).norm());
  }
  return most;
}

// While the picture moves fast: which share of the frame time, as the length of the smear, makes
// the patches most like what is seen.
void Tracker::Parts::learn_exposure() {
  if (exposure_known && counts.frames % 4 != 0) return;
  std::array<double, kExposures.size()> sums{};
  int count = 0;
  for (std::size_t i = 0; i < points.size() && count < 24; ++i) {
    if (fit.inlier[i] == 0) continue;
    const Candidate& candidate = candidates[static_cast<std::size_t>(point_candidate[i])];
    const Landmark& landmark = landmarks[static_cast<std::size_t>(candidate.landmark)];
    const Eigen::Vector3d now = camera_from_world * landmark.x_in_world;
    const Eigen::Vector3d then = previous * landmark.x_in_world;
    if (now.z() < LandmarkSearch::kNearest || then.z() < LandmarkSearch::kNearest) continue;
    const Eigen::Vector2d motion = camera.camera.project(now) - camera.camera.project(then);
    std::array<double, kExposures.size()> each{};
    bool usable = true;
    for (std::size_t e = 0; e < kExposures.size() && usable; ++e) {
      PatchTemplate look;
      usable = look.warp(landmark.look, 1, candidate.warp, kExposures[e] / 2 * motion);
      if (usable) {
        each[e] =
            likeness_at(pyramid.level(1), look, Pyramid::to_level(points[i].seen.uvd.head<2>(), 1));
      }
    }
    if (!usable) continue;
    for (std::size_t e = 0; e < each.size(); ++e) sums[e] += each[e];
    ++count;
  }
  if (count < 8) return;
  const auto best =
      static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
  exposure += (exposure_known ? 0.3 : 1.0) * (kExposures[best] - exposure);
  exposure_known = true;
}

void Tracker::Parts::rate_landmarks(int frame) {
  was_found.assign(candidates.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto c = static_cast<std::size_t>(point_candidate[i]);
    was_found[c] = 1;
    Landmark& landmark = landmarks[static_cast<std::size_t>(candidates[c].landmark)];
    if (fit.inlier[i] != 0) {
      ++landmark.inlier;
      landmark.last_frame = frame;
    } else {
      ++landmark.outlier;
      if (landmark.outlier > 4 && 2 * landmark.outlier > landmark.inlier) landmark.alive = false;
    }
  }
  if (smear_px > kBlurredPx) return;  // what is not found may be smeared
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (was_found[c] != 0) continue;
    Landmark& landmark = landmarks[static_cast<std::size_t>(candidates[c].landmark)];
    ++landmark.missed;
    if (landmark.missed > 30 && landmark.missed > 4 * landmark.inlier) landmark.alive = false;
  }
}

// --- frames ------------------------------------------------------------------------------------

TrackedPose Tracker::Parts::track(const TrackerFrame& frame) {
  const CpuTimer timer(counts.cpu_s);
  TrackedPose result;
  const int width = camera.camera.width;
  const int height = camera.camera.height;
  const auto fits = [&](const GrayImage* image) {
    return image == nullptr || (image->width() == width && image->height() == height);
  };
  const bool usable = frame.left != nullptr && frame.depth != nullptr && !frame.depth->empty() &&
                      fits(frame.left) && fits(frame.right);
  ++counts.frames;
  ++since_keyframe;
  const double dt = std::max(frame.time - last_time, 1e-3);
  last_time = frame.time;
  const int loops = counts.loops;
  if (pending && counts.frames >= pending_due) take_over();

  const int kept = counts.keyframes;
  if (!usable) {
    state = TrackState::kLost;
  } else if (keyframes.empty()) {
    const bool stands = start_watch.look(*frame.left, *frame.depth) == Stillness::kStill;
    state = stands ? TrackState::kStarting : TrackState::kLost;
    if (counts.frames % kStartEvery == 1) start(frame);
    result.new_world = !stands && !keyframes.empty();
  } else {
    bool standing = false;
    if (settings.watch_stillness && watch.begun() && state != TrackState::kTracking) {
      const Stillness seen = watch.look(*frame.left, frame.moving);
      standing = seen == Stillness::kStill;
      // Too little can be compared to say that it moves. What is dark or hidden need not move; but
      // a camera that shows nothing known for long is lost.
      if (seen == Stillness::kUnclear && state == TrackState::kFixed) fixed_unclear_s += dt;
      if (standing) {
        fixed_unclear_s = 0;
        state = TrackState::kFixed;
        ++counts.stood;
      }
    }
    if (!standing) {
      pyramid.build(*frame.left);
      const bool was_fixed = state == TrackState::kFixed;
      const Rigid3 held = camera_from_world;
      bool known = state != TrackState::kLost && follow_motion(frame, dt);
      if (!known && !(was_fixed && fixed_unclear_s > 0 && fixed_unclear_s < 1)) {
        known = come_back(frame);
      }
      if (known) {
        // A hand over a standing camera's patches is no motion.
        if (was_fixed && shift_px(held, camera_from_world) < 2 * kStillPx) {
          camera_from_world = previous = held;
          state = TrackState::kFixed;
        } else {
          accept(frame, dt);
        }
        fixed_unclear_s = 0;
      } else if (!(was_fixed && fixed_unclear_s > 0 && fixed_unclear_s < 1)) {
        state = TrackState::kLost;
        step = Rigid3::Identity();
        history.clear();
      }
    }
  }
  if (state == TrackState::kLost) ++counts.lost;
  // No minus zeros for a camera that has not moved.
  if (!camera_from_world.matrix().isIdentity(0))
    result.world_from_camera = inverse(camera_from_world);
  result.state = state;
  if (state == TrackState::kTracking) {
    result.landmarks = fit.inliers;
    result.tried = tried;
  }
  result.keyframe = counts.keyframes > kept;
  result.closed_loop = counts.loops > loops;
  if (!keyframes.empty()) {
    result.newest_keyframe = keyframes.back().number;
    result.keyframe_from_camera = keyframes.back().camera_from_world * result.world_from_camera;
  }
  return result;
}

void Tracker::Parts::start(const TrackerFrame& frame) {
  pyramid.build(*frame.left);
  points.clear();
  point_candidate.clear();
  fit.inlier.clear();
  fit.inliers = 0;
  keep(frame);
  if (keyframes.back().tracked < kLeastRecognised) {  // nothing could ever be followed from here
    keyframes.clear();
    landmarks.clear();
    free_slots.clear();
    pending.reset();
    loop_change.reset();
    confirmed.reset();
    counts.keyframes = 0;
    return;
  }
  if (settings.watch_stillness) {
    watch.begin(*frame.left);
    state = TrackState::kFixed;
  } else {
    state = TrackState::kTracking;
  }
}

bool Tracker::Parts::follow_motion(const TrackerFrame& frame, double dt) {
  const double share = step_time > 0 ? std::clamp(dt / step_time, 0.0, 3.0) : 0;
  const Rigid3 predicted = moved_by(Twist::Zero(), part_of(step, share) * camera_from_world);
  const bool sure = error_px < kSurePx && shift_px(camera_from_world, predicted) < kFastPx;
  if (sure && locate(frame, predicted, false, 2 * kLeastInliers)) return true;
  if (locate(frame, predicted, true, kLeastInliers)) return true;
  return locate(frame, camera_from_world, true, kLeastInliers);
}

// A pose that is known again: what follows from it.
void Tracker::Parts::accept(const TrackerFrame& frame, double dt) {
  const bool was_known = state == TrackState::kTracking || state == TrackState::kFixed;
  step = was_known ? Rigid3(camera_from_world * inverse(previous)) : Rigid3::Identity();
  step_time = dt;
  if (!was_known) error_px = 1e9;
  state = TrackState::kTracking;
  watch = {};  // what it shows is where the camera stood: it would be taken for where it is
  numbers.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (fit.inlier[i] != 0) numbers.push_back((camera_from_world * points[i].x_in_world).z());
  }
  if (!numbers.empty()) median_depth = upper_median(numbers);
  if (was_known && shift_px(previous, camera_from_world) > kFastPx) learn_exposure();
  rate_landmarks(counts.frames);
  if (wants_keyframe()) keep(frame);
  history.push_back({frame.time, camera_from_world});
  if (settings.watch_stillness) watch_for_standstill(frame);
}

void Tracker::Parts::watch_for_standstill(const TrackerFrame& frame) {
  const auto within = std::find_if(history.begin(), history.end(), [&](const Moment& moment) {
    return moment.time > frame.time - kStillSeconds;
  });
  // The one before them stays, and two at least.
  const std::ptrdiff_t gone = std::min(within - history.begin(), std::ssize(history) - 1) - 1;
  if (gone > 0) history.erase(history.begin(), history.begin() + gone);
  if (history.front().time > frame.time - kStillSeconds) return;
  for (const Moment& moment : history) {
    if (shift_px(moment.camera_from_world, camera_from_world) > kStillPx) return;
  }
  watch.begin(*frame.left);
  state = TrackState::kFixed;
  step = Rigid3::Identity();
  history.clear();
}

bool Tracker::Parts::come_back(const TrackerFrame& frame) {
  if (pending) take_over();  // so that the last keyframe can be recognised too
  const Thumbnail now = thumbnail_of(pyramid.level(2));
  std::vector<int> order(keyframes.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> alike(keyframes.size());
  for (std::size_t k = 0; k < keyframes.size(); ++k)
    alike[k] = likeness(now, keyframes[k].thumbnail);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return alike[static_cast<std::size_t>(a)] > alike[static_cast<std::size_t>(b)];
  });
  const Rigid3 held = camera_from_world;
  const auto try_near = [&](const Rigid3& pose) {
    camera_from_world = pose;  // no motion, no smear
    if (locate(frame, pose, true, kLeastRecognised)) {
      if (state == TrackState::kLost) ++counts.recognised;
      state = TrackState::kLost;  // accept() is to begin without a motion
      return true;
    }
    camera_from_world = held;
    return false;
  };
  if (try_near(held) ||
      try_near(keyframes[static_cast<std::size_t>(order.front())].camera_from_world))
    return true;

  const PinholeCamera half = camera.camera.scaled_down(2);
  const Features features = find_features(pyramid.level(1), half, *frame.depth);
  if (features.uv.empty()) return false;
  constexpr int kAsked = 3;
  std::vector<int> asked(order.begin(),
                         order.begin() + std::min<std::ptrdiff_t>(kAsked, std::ssize(order)));
  next_asked = (next_asked + 1) % static_cast<int>(keyframes.size());
  asked.push_back(next_asked);
  for (const int k : asked) {
    const Keyframe& keyframe = keyframes[static_cast<std::size_t>(k)];
    const std::optional<Recognised> seen = recognise(features, keyframe.features, half);
    if (seen && try_near(seen->camera_from_old * keyframe.camera_from_world)) return true;
  }
  return false;
}

// --- keyframes ---------------------------------------------------------------------------------

bool Tracker::Parts::wants_keyframe() const {
  if (since_keyframe < kKeyframeGap) return false;
  if (fit.inliers < kMust) return true;
  if (smear_px > kBlurredPx) return false;
  if (fit.inliers < kFew || fit.inliers < kFewer * keyframes.back().tracked) return true;
  const Rigid3 world_from_camera = inverse(camera_from_world);
  for (const Keyframe& keyframe : keyframes) {
    const Rigid3 motion = keyframe.camera_from_world * world_from_camera;
    const double angle = Eigen::AngleAxisd(motion.linear()).angle();
    if (motion.translation().norm() < kFarMoved * median_depth && angle < kTurned) return false;
  }
  return true;
}

void Tracker::Parts::keep(const TrackerFrame& frame) {
  if (pending) take_over();
  Keyframe keyframe;
  keyframe.number = frame.number;
  keyframe.time = frame.time;
  keyframe.camera_from_world = camera_from_world;
  keyframe.thumbnail = thumbnail_of(pyramid.level(2));
  const int index = static_cast<int>(keyframes.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (fit.inlier[i] == 0) continue;
    const int id = candidates[static_cast<std::size_t>(point_candidate[i])].landmark;
    landmarks[static_cast<std::size_t>(id)].sightings.push_back({index, points[i].seen});
    keyframe.landmarks.push_back(id);
  }
  keyframes.push_back(std::move(keyframe));
  const int room = settings.limits.landmarks - static_cast<int>(landmarks.size()) +
                   static_cast<int>(free_slots.size());
  if (std::ssize(keyframes) > settings.limits.keyframes ||
      room < settings.most_landmarks + kNewLandmarks) {
    make_room(camera_from_world, settings.limits, kWindow, keyframes, landmarks, free_slots);
  }
  add_corners(frame, keyframes.back());
  Keyframe& kept = keyframes.back();
  kept.tracked = static_cast<int>(kept.landmarks.size());
  std::vector<double> depths;
  for (const int id : kept.landmarks) {
    depths.push_back(
        (kept.camera_from_world * landmarks[static_cast<std::size_t>(id)].x_in_world).z());
  }
  if (!depths.empty()) median_depth = kept.median_depth = upper_median(depths);
  since_keyframe = 0;
  ++counts.keyframes;
  ask_for_work(frame);
}

// What could be found in this keyframe but was not, or was not looked for.
void Tracker::Parts::find_unfound(const TrackerFrame& frame) {
  unfound.clear();
  if (smear_px > kBlurredPx) return;  // what is not found may be smeared
  std::vector<char> done(landmarks.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Candidate& candidate = candidates[static_cast<std::size_t>(point_candidate[i])];
    if (fit.inlier[i] != 0) done[static_cast<std::size_t>(candidate.landmark)] = 1;
  }
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (done[i] != 0) continue;
    if (auto candidate = search().expected(frame, static_cast<int>(i), camera_from_world)) {
      unfound.push_back(*candidate);
    }
  }
}

// Whether a corner is a landmark's place. It is looked for there once more: found, the keyframe has
// it; not found, it looks otherwise by now and the corner takes its place.
bool Tracker::Parts::is_older(const TrackerFrame& frame, const Eigen::Vector3d& uvd,
                              Keyframe& keyframe) {
  const double f_T = camera.camera.fx_px * camera.baseline;
  for (Candidate& candidate : unfound) {
    if ((candidate.uv - uvd.head<2>()).squaredNorm() > kSamePlace * kSamePlace) continue;
    Landmark& landmark = landmarks[static_cast<std::size_t>(candidate.landmark)];
    if (!landmark.alive) continue;
    candidate.warp =
        image_from_anchor(camera, landmark, anchor_pose(landmark, keyframes), camera_from_world);
    Eigen::Vector2d uv;
    int level = 0;
    const bool found = search().find(candidate, 1, 0, kFineLikeness, uv, level);
    const Sighting seen = search().sighting_of(frame, candidate, found ? uv : candidate.uv, level);
    const double off = std::abs(f_T / candidate.depth - uvd.z());
    if (off > kSameDepth * std::max(seen.sigma_d, LandmarkSearch::kSigmaStereo))
      continue;  // another surface
    if (!found || (uv - candidate.uv).norm() > kSamePlace) {
      landmark.alive = false;
      continue;
    }
    landmark.sightings.push_back({static_cast<int>(keyframes.size()) - 1, seen});
    landmark.last_frame = counts.frames;
    keyframe.landmarks.push_back(candidate.landmark);
    return true;
  }
  return false;
}

void Tracker::Parts::remember(Landmark landmark, Keyframe& keyframe) {
  int slot = static_cast<int>(landmarks.size());
  if (free_slots.empty()) {
    landmarks.push_back(std::move(landmark));
  } else {
    slot = free_slots.back();
    free_slots.pop_back();
    landmarks[static_cast<std::size_t>(slot)] = std::move(landmark);
  }
  keyframe.landmarks.push_back(slot);
}

void Tracker::Parts::add_corners(const TrackerFrame& frame, Keyframe& keyframe) {
  std::vector<Eigen::Vector2d> taken;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (fit.inlier[i] != 0) taken.emplace_back(points[i].seen.uvd.head<2>());
  }
  const int room = settings.most_landmarks + kNewLandmarks - static_cast<int>(taken.size());
  const std::vector<Corner> corners = new_corners(pyramid.level(1), *frame.depth, frame.moving,
                                                  taken, LandmarkSearch::kCellsAcross, room);
  const double f_T = camera.camera.fx_px * camera.baseline;
  const Rigid3 world_from_camera = inverse(camera_from_world);
  const int index = static_cast<int>(keyframes.size()) - 1;
  find_unfound(frame);
  for (const Corner& corner : corners) {
    if (free_slots.empty() && std::ssize(landmarks) >= settings.limits.landmarks) break;
    const Eigen::Vector2d uv = corner.uv;
    if (!(uv.x() > 9 && uv.y() > 9 && uv.x() < camera.camera.width - 10 &&
          uv.y() < camera.camera.height - 10)) {
      continue;
    }
    const double expected = f_T / corner.depth;
    const std::optional<double> d = search().disparity_at(frame, uv, expected);
    if (!d || *d < 0.5 || std::abs(*d - expected) > 1.5) continue;
    if (is_older(frame, {uv.x(), uv.y(), *d}, keyframe)) continue;
    Landmark landmark;
    landmark.uv = uv;
    landmark.anchor = index;
    landmark.slope = corner.slope;
    Sighting seen;
    seen.uvd = {uv.x(), uv.y(), *d};
    // The patch itself defines where the point is: no error of finding it.
    seen.sigma = 0.7 * LandmarkSearch::kSigma;
    seen.sigma_d = search().sigma_of_disparity(frame, *d);
    landmark.x_in_world = world_from_camera * camera.point(seen.uvd);
    landmark.look = PatchSource::cut(pyramid, uv);
    landmark.sightings.push_back({index, seen});
    landmark.last_frame = counts.frames;
    remember(std::move(landmark), keyframe);
  }
}

// --- beside the frames -------------------------------------------------------------------------

void Tracker::Parts::ask_for_work(const TrackerFrame& frame) {
  Work work;
  work.number = frame.number;
  work.image = pyramid.level(1);
  work.image_camera = camera.camera.scaled_down(2);
  work.depth = *frame.depth;
  if (confirmed) {
    work.closing = std::exchange(confirmed, std::nullopt);
    work.graph = graph_of(camera, keyframes, landmarks, *work.closing);
  }
  if (!work.graph && settings.adjust && keyframes.size() > 1) {
    work.window = window_of(camera, keyframes, landmarks);
  }
  if (settings.close_loops && !work.graph) {
    for (const int k : loop_candidates(keyframes, landmarks, kLoopCandidates)) {
      const Keyframe& keyframe = keyframes[static_cast<std::size_t>(k)];
      work.asked.emplace_back(keyframe.number, keyframe.features);
    }
  }
  const auto shared = std::make_shared<Work>(std::move(work));
  const auto work_out = [shared] { return worked_out(std::move(*shared)); };
  pending = std::async(std::launch::deferred, work_out);
  deferred = true;
  if (settings.adjust_on_thread) {
    try {
      pending = std::async(std::launch::async, work_out);
      deferred = false;
    } catch (const std::system_error&) {  // no thread to be had: the same numbers, later
    }
  }
  pending_due = counts.frames + kLatency;
}

void Tracker::Parts::take_over() {
  // On a thread of its own it is not part of this one's CPU time; deferred, it is subtracted.
  const double before = thread_cpu_seconds();
  Work done = pending->get();
  pending.reset();
  counts.adjust_cpu_s += done.cpu_s;
  if (deferred) counts.cpu_s -= thread_cpu_seconds() - before;

  keyframes.back().features = std::move(done.features);
  const Rigid3 newest = keyframes.back().camera_from_world;
  if (done.window) put_back(*done.window, keyframes, landmarks);
  if (done.graph && done.closed) {
    corrections.clear();
    for (const Keyframe& k : keyframes) corrections.push_back({k.number, k.camera_from_world});
    put_back(*done.graph, keyframes, landmarks);
    for (std::size_t k = 0; k < keyframes.size(); ++k) {
      Rigid3& correction = corrections[k].world_from_drifted;  // holds camera_from_drifted
      correction = inverse(keyframes[k].camera_from_world) * correction;
    }
    forget_doubles(camera, *done.closing, keyframes, landmarks);
    error_px = 1e9;  // old landmarks are to be looked for from far
    ++counts.loops;
  }
  // Where the camera is, seen from the newest keyframe, has not changed.
  const Rigid3 change = inverse(newest) * keyframes.back().camera_from_world;
  camera_from_world = moved_by(Twist::Zero(), camera_from_world * change);
  previous = moved_by(Twist::Zero(), previous * change);
  for (Moment& moment : history) moment.camera_from_world = moment.camera_from_world * change;
  if (settings.close_loops) consider(done.loop);
}

// Two keyframes in turn have to say the same: what looks alike by chance does not.
void Tracker::Parts::consider(const std::optional<Loop>& loop) {
  const std::optional<Rigid3> by_loop = loop ? pose_by(*loop, keyframes) : std::nullopt;
  const Rigid3& now = keyframes.back().camera_from_world;
  if (!by_loop || shift_px(now, *by_loop) < kLoopPx) {
    loop_change.reset();
    return;
  }
  if (loop_change && shift_px(now * *loop_change, *by_loop) < kLoopPx) {
    confirmed = loop;
    loop_change.reset();
  } else {
    loop_change = inverse(now) * *by_loop;
  }
}

// --- the outside -------------------------------------------------------------------------------

Tracker::Tracker(const TrackerSettings& settings) : parts_(std::make_unique<Parts>(settings)) {
  PALPABLE_EXPECT(settings.camera.camera.fx_px > 0 && settings.camera.camera.fy_px > 0 &&
                      settings.camera.baseline > 0,
                  "focal lengths and baseline are positive");
  PALPABLE_EXPECT(settings.limits.keyframes >= 2 * kWindow &&
                      settings.limits.landmarks >= 2 * (settings.most_landmarks + kNewLandmarks),
                  "14 keyframes and the landmarks of two frames are remembered at least");
}
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;
Tracker::~Tracker() = default;

TrackedPose Tracker::track(const TrackerFrame& frame) { return parts_->track(frame); }

std::vector<KeyframePose> Tracker::keyframes() const {
  std::vector<KeyframePose> poses;
  for (const Keyframe& k : parts_->keyframes) {
    poses.push_back({k.number, k.time, inverse(k.camera_from_world)});
  }
  return poses;
}

std::span<const Correction> Tracker::corrections() const { return parts_->corrections; }

TrackerCounts Tracker::counts() const {
  TrackerCounts counts = parts_->counts;
  counts.kept_keyframes = static_cast<int>(parts_->keyframes.size());
  counts.landmarks =
      static_cast<int>(std::count_if(parts_->landmarks.begin(), parts_->landmarks.end(),
                                     [](const Landmark& landmark) { return landmark.alive; }));
  return counts;
}

}  // namespace palpable
