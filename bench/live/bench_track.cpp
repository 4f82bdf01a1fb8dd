// palpable bench track: CPU time of tracking and of the map, and errors compared with the truth.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_writer/desk_film.h"
#include "palpable/desk/score/camera_scores.h"
#include "palpable/desk/score/depth_scores.h"
#include "palpable/desk/script/plan_sequence.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/slam/slam.h"
#include "palpable/live/sources/folder_source.h"
#include "palpable/live/track/tracker_input.h"

#include <fmt/core.h>

#include "bench/live/bench.h"
#include "bench/live/bench_map.h"
#include "bench/live/opencv_odometry.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr int kWalkFrames = 900;        // of the planned sequence
constexpr int kSkipped = 10;            // first frames, which allocate, are not timed
constexpr int kFixedFrames = 40;        // with a camera on a tripod
constexpr int kDarkFrames = 30;         // 1 s
constexpr int kAfterDark = 30;          // frames within which the camera should find its pose again
constexpr double kFoundWithin = 0.010;  // m; a pose with a larger error counts as not found
constexpr double kMoved = 0.1;          // m from its start: the camera has moved
constexpr int kQuick = 6;               // interval between the frames of the kitchen that are read
// m, largest depth for OpenCV's odometry: its own default, and the value needed for the street.
constexpr double kKitchenDepth = 4;
constexpr double kStreetDepth = 60;

struct TrackBenchOptions {
  fs::path body;
  fs::path data = "../shared/data";
  std::uint64_t seed = 1;
  int frames = 120;
  int hand_frames = 240;
  bool json = false;
};

// --- the walk: CPU time, and time to find the pose again after a second of darkness -------------

void bench_walk(const ReducedBody& body, const TrackBenchOptions& options, ProgressBar& bar,
                Json& result) {
  const Sequence sequence = plan_sequence("walk", desk_body(body), kWalkFrames, options.seed);
  Film film = film_of(sequence);
  const FrameFormat format = format_of(film.rig);
  DepthCamera camera = value_or_throw(DepthCamera::make(format));
  Tracker tracker(tracker_settings(camera));

  const int dark_end = options.frames + kDarkFrames;
  const int last = std::min(dark_end + kAfterDark, kWalkFrames);
  RawPair pair;
  Frame frame;
  SeenFrame seen;
  TrackerCounts before;
  std::optional<int> back;
  for (int n = 0; n < last; ++n) {
    const bool dark = n >= options.frames && n < dark_end;
    if (!dark) {
      film.renderer.draw(moment_of(sequence, n), pair);
      frame.left = pair.left;
      frame.right = pair.right;
    } else {
      std::fill(frame.left.begin(), frame.left.end(), Rgb{3, 3, 3});
      std::fill(frame.right.begin(), frame.right.end(), Rgb{3, 3, 3});
    }
    frame.number = n;
    frame.time = n / 30.0;
    camera.see(frame, seen);
    if (n == kSkipped) before = tracker.counts();
    const TrackedPose pose = tracker.track(tracker_frame(seen));
    const double off =
        (pose.world_from_camera.translation() - world_from_camera(sequence, n).translation())
            .norm();
    if (n >= dark_end && is_known(pose) && off <= kFoundWithin) {
      back = n;
      break;
    }
    if (n == options.frames - 1) {
      // An adjustment in progress is not counted: it is one of many.
      const TrackerCounts now = tracker.counts();
      const double frames = now.frames - before.frames;
      result["cpu_ms_720p"] =
          1e3 * (now.cpu_s + now.adjust_cpu_s - before.cpu_s - before.adjust_cpu_s) / frames;
      result["adjust_ms_720p"] = 1e3 * (now.adjust_cpu_s - before.adjust_cpu_s) / frames;
      result["lost_before_dark"] = now.lost;
    }
    bar.show({"walking", n + 1.0, static_cast<double>(last), ""});
  }
  result["relocalise_s"] = back ? Json((*back - dark_end) / 30.0) : Json(nullptr);
}

// --- a fixed camera: CPU time until it is known to be fixed --------------------------------------

void bench_fixed(const ReducedBody& body, const TrackBenchOptions& options, ProgressBar& bar,
                 Json& result) {
  const Sequence sequence =
      plan_sequence("still-tripod", desk_body(body), kFixedFrames, options.seed);
  Film film = film_of(sequence);
  const FrameFormat format = format_of(film.rig);
  DepthCamera camera = value_or_throw(DepthCamera::make(format));
  Tracker tracker(tracker_settings(camera));
  RawPair pair;
  Frame frame;
  SeenFrame seen;
  TrackerCounts before;
  for (int n = 0; n < kFixedFrames; ++n) {
    film.renderer.draw(moment_of(sequence, n), pair);
    frame.left = pair.left;
    frame.right = pair.right;
    frame.number = n;
    frame.time = n / 30.0;
    camera.see(frame, seen);
    if (n == kSkipped) before = tracker.counts();
    tracker.track(tracker_frame(seen));
    bar.show({"standing", n + 1.0, static_cast<double>(kFixedFrames), ""});
  }
  const TrackerCounts now = tracker.counts();
  const double frames = now.frames - before.frames;
  result["fixed_cpu_ms"] =
      1e3 * (now.cpu_s + now.adjust_cpu_s - before.cpu_s - before.adjust_cpu_s) / frames;
  result["fixed_share"] = (now.stood - before.stood) / frames;
}

// --- recordings ----------------------------------------------------------------------------------

// A tracked recording with the poses published with its data set: of the left camera, or of
// the depth camera.
struct Followed {
  std::vector<PosePair> pairs;
  std::vector<PosePair> opencv;    // by OpenCV's RGB-D odometry; FollowSettings::opencv
  std::vector<DepthImage> depths;  // as recorded; FollowSettings::keep_depths
  PinholeCamera depth_camera;
  int lost = 0;        // frames without a pose
  int identities = 0;  // frames in which the camera has moved but its pose is the identity
};

struct FollowSettings {
  int every = 1;           // interval of the frames that are read: a faster camera
  bool with_mask = false;  // moving things are masked, as in `palpable live`
  bool keep_depths = false;
  double opencv = 0;  // m, largest depth for OpenCV's odometry; 0: it is not run
};

// Tracks the camera in a folder; the published poses are assigned by frame number.
Followed follow(const fs::path& folder, const FollowSettings& how) {
  const std::vector<StampedPose> published = read_published_poses(folder).poses;
  auto source = value_or_throw(open_folder(folder));
  DepthCamera camera = value_or_throw(DepthCamera::make(source->format()));
  Slam slam(camera, {.map = how.with_mask});
  OpenCvOdometry odometry(camera.camera(), how.opencv > 0 ? how.opencv : 1);
  Followed followed;
  followed.depth_camera = source->format().depth_camera;
  const auto& color = source->format().color_sensor;
  const Rigid3 camera_from_depth = color ? color->color_from_depth : Rigid3::Identity();
  Frame frame;
  SeenFrame seen;
  StageTimes times;
  int read = 0;
  FrameStatus status = source->next(frame);
  for (; status != FrameStatus::kEnd; status = source->next(frame)) {
    if (status != FrameStatus::kFrame || read++ % how.every != 0) continue;
    camera.see(frame, seen);
    const TrackedPose pose = slam.advance(seen, times).camera;
    const Rigid3 truth = published.at(static_cast<std::size_t>(seen.number)).world_from_camera;
    followed.pairs.push_back({seen.time, truth, pose.world_from_camera * camera_from_depth});
    if (how.opencv > 0) {
      followed.opencv.push_back({seen.time, truth, odometry.follow(seen) * camera_from_depth});
    }
    if (how.keep_depths) followed.depths.push_back(frame.depth);
    const double moved =
        (followed.pairs.front().truth.inverse() * truth).translation().norm();  // m
    const bool lost = pose.state == TrackState::kLost;
    followed.lost += lost ? 1 : 0;
    followed.identities +=
        !lost && moved > kMoved && pose.world_from_camera.matrix().isIdentity(0) ? 1 : 0;
  }
  return followed;
}

double ate_mm(std::span<const PosePair> pairs) { return 1e3 * score_trajectory(pairs).ate; }

void bench_kitchen(const fs::path& folder, Json& result) {
  for (const char* key :
       {"ate_7scenes_mm", "ate_7scenes_mm_opencv", "opencv_ratio_7scenes", "warp_ratio_7scenes"}) {
    result[key] = nullptr;
  }
  if (!fs::exists(folder)) return;
  const Followed f = follow(folder, {.keep_depths = true, .opencv = kKitchenDepth});
  if (f.pairs.empty()) return;
  result["ate_7scenes_mm"] = ate_mm(f.pairs);
  result["ate_7scenes_mm_opencv"] = ate_mm(f.opencv);
  result["opencv_ratio_7scenes"] = ate_mm(f.pairs) / ate_mm(f.opencv);
  std::vector<Rigid3> found, truth;
  for (const PosePair& pair : f.pairs) {
    found.push_back(pair.found);
    truth.push_back(pair.truth);
  }
  const auto ours = warped_disagreement(f.depths, found, f.depth_camera);
  const auto published = warped_disagreement(f.depths, truth, f.depth_camera);
  if (!ours || !published) return;
  result["warp_mm_7scenes"] = 1e3 * *ours;
  result["warp_mm_7scenes_published"] = 1e3 * *published;
  result["warp_ratio_7scenes"] = *ours / *published;
}

// The kitchen's first 400 frames, and every sixth of them: a hand that turns six times as fast.
void bench_long_kitchen(const fs::path& folder, Json& result) {
  for (const char* key :
       {"ate_7scenes_long_mm", "ate_7scenes_long_mm_opencv", "opencv_ratio_7scenes_long",
        "ate_7scenes_long_first_half_mm", "ate_7scenes_long_second_half_mm", "7scenes_long_lost",
        "7scenes_quick_lost", "ate_7scenes_quick_mm"}) {
    result[key] = nullptr;
  }
  if (!fs::exists(folder)) return;
  const Followed f = follow(folder, {.opencv = kKitchenDepth});
  if (f.pairs.size() < 2) return;
  const std::span<const PosePair> pairs = f.pairs;
  result["ate_7scenes_long_mm"] = ate_mm(pairs);
  result["ate_7scenes_long_mm_opencv"] = ate_mm(f.opencv);
  result["opencv_ratio_7scenes_long"] = ate_mm(pairs) / ate_mm(f.opencv);
  result["ate_7scenes_long_first_half_mm"] = ate_mm(pairs.first(pairs.size() / 2));
  result["ate_7scenes_long_second_half_mm"] = ate_mm(pairs.subspan(pairs.size() / 2));
  result["7scenes_long_lost"] = f.lost;
  const Followed quick = follow(folder, {.every = kQuick, .with_mask = true});
  result["7scenes_quick_lost"] = quick.lost;
  result["ate_7scenes_quick_mm"] = ate_mm(quick.pairs);
}

// Error of the last camera position relative to the first camera, divided by the length
// of the true path.
double end_error(std::span<const PosePair> pairs) {
  double path = 0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    path += (pairs[i].truth.translation() - pairs[i - 1].truth.translation()).norm();
  }
  const auto way = [](const Rigid3& first, const Rigid3& last) -> Eigen::Vector3d {
    return (first.inverse() * last).translation();
  };
  const Eigen::Vector3d error =
      way(pairs.front().truth, pairs.back().truth) - way(pairs.front().found, pairs.back().found);
  return error.norm() / path;
}

void bench_street(const fs::path& folder, Json& result) {
  result["kitti_position_error"] = result["kitti_position_error_opencv"] = nullptr;
  if (!fs::exists(folder)) return;
  const Followed f = follow(folder, {.opencv = kStreetDepth});
  if (f.pairs.empty()) return;
  result["kitti_position_error"] = end_error(f.pairs);
  result["kitti_position_error_opencv"] = end_error(f.opencv);
}

// The whole clip, and the clip at two to four times the speed: up to 4.8 m between pictures.
void bench_long_street(const fs::path& folder, Json& result) {
  for (const char* key :
       {"kitti_long_position_error", "kitti_long_position_error_opencv",
        "kitti_long_first_half_error", "kitti_long_second_half_error", "kitti_long_lost",
        "kitti_fast_lost", "kitti_fast_position_error", "identity_poses_of_moving"}) {
    result[key] = nullptr;
  }
  if (!fs::exists(folder)) return;
  const Followed f = follow(folder, {.with_mask = true, .opencv = kStreetDepth});
  if (f.pairs.size() < 4) return;
  const std::span<const PosePair> pairs = f.pairs;
  result["kitti_long_position_error"] = end_error(pairs);
  result["kitti_long_position_error_opencv"] = end_error(f.opencv);
  result["kitti_long_first_half_error"] = end_error(pairs.first(pairs.size() / 2));
  result["kitti_long_second_half_error"] = end_error(pairs.subspan(pairs.size() / 2));
  result["kitti_long_lost"] = f.lost;
  int lost = 0, identities = f.identities;
  double worst = 0;
  for (int every = 2; every <= 4; ++every) {
    const Followed fast = follow(folder, {.every = every, .with_mask = true});
    lost += fast.lost;
    identities += fast.identities;
    worst = std::max(worst, end_error(fast.pairs));
  }
  result["kitti_fast_lost"] = lost;
  result["kitti_fast_position_error"] = worst;
  result["identity_poses_of_moving"] = identities;
}

void print_track_table(const Json& r) {
  const auto line = [&](const char* what, const char* key, double scale, const char* bar) {
    fmt::print(
        "{:<52}{:>10}{:>12}\n", what,
        r[key].is_null() ? std::string("-") : fmt::format("{:.3f}", scale * r[key].get<double>()),
        bar);
  };
  fmt::print("{:<52}{:>10}{:>12}\n", "", "this", "at most");
  line("CPU ms per 720p frame, adjustment included", "cpu_ms_720p", 1, "8");
  line("  of it the adjustment", "adjust_ms_720p", 1, "");
  line("  where the camera stands", "fixed_cpu_ms", 1, "");
  line("CPU ms per depth image fused into the map", "map_ms", 1, "3");
  line("CPU ms per frame: what moves, and free space", "mask_ms", 1, "1");
  line("map cells where the hand was and nothing is", "ghost_voxels", 1, "0");
  line("  the same without the mask", "ghost_voxels_no_mask", 1, "");
  line("7-Scenes kitchen, 90 frames: path error, mm", "ate_7scenes_mm", 1, "25");
  line("  by OpenCV's RGB-D odometry", "ate_7scenes_mm_opencv", 1, "");
  line("  depth warped by our poses / by the published", "warp_ratio_7scenes", 1, "1.1");
  line("  400 frames: path error, mm", "ate_7scenes_long_mm", 1, "30");
  line("  by OpenCV's RGB-D odometry", "ate_7scenes_long_mm_opencv", 1, "");
  line("  ours by OpenCV's", "opencv_ratio_7scenes_long", 1, "0.8");
  line("  its first half, mm", "ate_7scenes_long_first_half_mm", 1, "");
  line("  its second half, mm", "ate_7scenes_long_second_half_mm", 1, "");
  line("  frames lost", "7scenes_long_lost", 1, "0");
  line("  every sixth frame: frames lost", "7scenes_quick_lost", 1, "0");
  line("KITTI street, 16 pairs: end position, % of the path", "kitti_position_error", 100, "2");
  line("  51 pairs", "kitti_long_position_error", 100, "1.2");
  line("  by OpenCV's RGB-D odometry", "kitti_long_position_error_opencv", 100, "");
  line("  its first half", "kitti_long_first_half_error", 100, "");
  line("  its second half", "kitti_long_second_half_error", 100, "");
  line("  frames lost", "kitti_long_lost", 1, "0");
  line("  every 2nd to 4th pair: frames lost", "kitti_fast_lost", 1, "0");
  line("  the worst of their ends, % of the path", "kitti_fast_position_error", 100, "");
  line("  identity poses of a camera that has moved", "identity_poses_of_moving", 1, "0");
  line("after 1 s of darkness: found again, s", "relocalise_s", 1, "0.5");
}

void bench_track(const TrackBenchOptions& options) {
  ProgressBar bar;
  Json result;
  result["bench"] = "track";
  result["seed"] = options.seed;
  const ReducedBody body =
      value_or_throw(read_pressable_body(options.body.empty() ? default_body() : options.body));
  bench_walk(body, options, bar, result);
  bench_fixed(body, options, bar, result);
  bench_map(body, options.seed, options.hand_frames, bar, result);
  bar.finish();
  bench_kitchen(options.data / "rgbd_pose_7scenes", result);
  bench_long_kitchen(options.data / "rgbd_pose_7scenes_long", result);
  bench_street(options.data / "stereo_video_kitti1", result);
  bench_long_street(options.data / "stereo_video_kitti1_long", result);
  if (options.json) {
    fmt::print("{}\n", result.dump(2));
  } else {
    print_track_table(result);
  }
}

}  // namespace

void add_bench_track(Command bench) {
  auto options = std::make_shared<TrackBenchOptions>();
  Command command = bench.add_subcommand(
      "track", "Following the camera, the map: CPU time, recordings with truth, lost and found");
  command.add_option("--body", options->body, "Body file")
      .default_is("build/bodies/bunny-dense.palpable, else out/demo/bunny.palpable");
  command.add_option("--seed", options->seed, "Seed of the sequence walk")
      .in_range(std::uint64_t{0}, kLargestSeed)
      .show_default();
  command.add_option("--frames", options->frames, "Frames of the walk, before the darkness")
      .in_range(2 * kSkipped, kWalkFrames - kDarkFrames - 1)
      .show_default();
  command.add_option("--hand-frames", options->hand_frames, "Frames of the walk with a hand")
      .in_range(kFewestHandFrames, kWalkFrames)
      .show_default();
  command
      .add_option(
          "--data", options->data,
          "Folder that holds rgbd_pose_7scenes, stereo_video_kitti1 and the same with _long; what "
          "is missing is null")
      .show_default();
  command.add_json(options->json);
  command.footer(
      "The walk is filmed for the bench, at 1280 x 720; from frame 10 on its CPU time counts, mean "
      "over "
      "frames, all threads. Then 1 s of darkness. fixed_cpu_ms is the same of a camera on a "
      "tripod, "
      "fixed_share the share of its frames in which nothing but its patches was looked for. A "
      "third "
      "film, of the walk with a hand, is mapped.\n"
      "Example: palpable bench track --json");
  command.callback([options] { bench_track(*options); });
}

}  // namespace palpable::app
