#include "palpable/live/slam/room_scan.h"

#include "palpable/common/base/error.h"
#include "palpable/live/depth/depth_camera.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace palpable {
namespace {

// Returns world_from_camera of a frame if poses are given instead of tracked.
using PoseOf = std::function<std::optional<Rigid3>(int index, const SeenFrame& seen)>;

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

// Passes the reports of a second pass on only if the first has not had them.
std::function<bool(const RoomScanStep&)> each_report_once(
    const std::function<bool(const RoomScanStep&)>& go_on) {
  return [&go_on, had = std::set<std::string>()](const RoomScanStep& step) mutable {
    RoomScanStep news = step;
    if (step.again) {
      std::erase_if(news.reports, [&](const std::string& line) { return had.contains(line); });
    } else {
      had.insert(step.reports.begin(), step.reports.end());
    }
    return go_on(news);
  };
}

// One pass through a source.
// @param depth    settings for the depth of the frames
// @param most     largest number of frames that are read; -1: all
// @param pose_of  empty: the camera is tracked
// @param again    this is the second pass: it reads `most` frames, whatever `go_on` returns
RoomScan play(FrameSource& source, const std::string& name, const DepthSettings& depth,
              const SlamSettings& settings, int most, const PoseOf& pose_of, bool again,
              const std::function<bool(const RoomScanStep&)>& go_on) {
  Result<DepthCamera> made = DepthCamera::make(source.format(), depth);
  if (!made.ok()) throw Error(name + ": " + made.problem().message);
  DepthCamera camera = std::move(made).value();
  RoomScan scan;
  scan.slam = std::make_unique<Slam>(camera, settings);
  scan.camera = camera.camera();
  RoomScanStep step;
  step.again = again;
  step.total = source.frame_count();
  if (most > 0) step.total = step.total > 0 ? std::min(step.total, most) : most;
  Frame frame;
  SeenFrame seen;
  SourceGuard guard(source);
  StageTimes times;
  DepthSurvey survey(name, source.format(), camera.rectified());
  bool goes_on = true;
  while ((most < 0 || step.read < most) && (again || goes_on)) {
    const FrameStatus status = guard.next(frame);
    step.reports = guard.take_reports();
    if (status == FrameStatus::kFrame) camera.see(frame, seen);
    if (status == FrameStatus::kFrame && !seen.misfit) {
      scan.frames.push_back(pose_of
                                ? scan.slam->advance(seen, pose_of(step.read, seen), times).camera
                                : scan.slam->advance(seen, times).camera);
      survey.add(seen);
      append(step.reports, survey.take_warnings());
      ++step.read;
      step.blocks = scan.slam->map()->blocks();
    }
    goes_on = go_on(step);
    if (seen.misfit) throw Error(name + ": " + seen.misfit->message());
    if (status == FrameStatus::kEnd) break;
  }
  survey.finish();
  step.reports = survey.take_warnings();
  if (!step.reports.empty()) go_on(step);
  scan.depth = survey.figures();
  scan.troubles = guard.troubles();
  scan.last_trouble = guard.last_trouble();
  return scan;
}

}  // namespace

std::vector<std::optional<Rigid3>> corrected_path(std::span<const TrackedPose> frames,
                                                  std::span<const KeyframePose> keyframes) {
  std::map<int, Rigid3> world_from_keyframe;
  for (const KeyframePose& k : keyframes) world_from_keyframe[k.number] = k.world_from_camera;
  std::vector<std::optional<Rigid3>> poses;
  for (const TrackedPose& frame : frames) {
    const auto keyframe = world_from_keyframe.find(frame.newest_keyframe);
    poses.emplace_back();
    if (is_known(frame) && keyframe != world_from_keyframe.end()) {
      poses.back() = keyframe->second * frame.keyframe_from_camera;
    }
  }
  return poses;
}

void set_farthest(double farthest, RoomScanSettings& settings) {
  SurfaceMapSettings& surface = settings.slam.surface;
  // The standard deviation of depth grows with the square of the distance. The limit grows only
  // linearly, because otherwise the surface would be blurred over metres.
  const double farther = std::max(farthest / surface.farthest, 1.0);
  surface.best_sigma *= farther * farther;
  surface.largest_sigma *= farther;
  surface.farthest = farthest;
  // Tracking also uses points beyond the surface's range.
  settings.depth.farthest = farthest < kUsualFarthest ? std::nullopt : std::optional(farthest);
}

RoomScan scan_room(const OpenSource& open, const RoomScanSettings& settings,
                   const std::function<bool(const RoomScanStep&)>& go_on) {
  const std::function<bool(const RoomScanStep&)> once = each_report_once(go_on);
  SlamSettings slam = settings.slam;
  slam.map = true;
  slam.track = !settings.pose_at;
  PoseOf pose_of;
  if (settings.pose_at) {
    pose_of = [&](int, const SeenFrame& seen) { return settings.pose_at(seen.time); };
  }
  std::unique_ptr<FrameSource> source = open();
  RoomScan first = play(*source, settings.name, settings.depth, slam, settings.most_frames, pose_of,
                        false, once);
  const Tracker* tracker = first.slam->tracker();
  if (tracker == nullptr) return first;
  first.keyframes = tracker->keyframes();
  first.loops = tracker->counts().loops;
  first.new_worlds = tracker->counts().new_worlds;
  if (first.loops == 0 || source->is_live()) return first;

  const std::vector<std::optional<Rigid3>> path = corrected_path(first.frames, first.keyframes);
  const auto pose_as_corrected = [&](int index, const SeenFrame&) { return path[index]; };
  first.slam.reset();  // one map at a time
  slam.track = false;
  source = open();
  RoomScan second = play(*source, settings.name, settings.depth, slam,
                         static_cast<int>(first.frames.size()), pose_as_corrected, true, once);
  second.keyframes = std::move(first.keyframes);
  second.loops = first.loops;
  second.depth = first.depth;
  second.new_worlds = first.new_worlds;
  second.again = true;
  return second;
}

ColoredSurface surface_of(const RoomScan& scan) {
  constexpr int kTooFewToAgree = 3;  // fused frames up to which voxels of any weight are used
  const SurfaceMap& map = *scan.slam->map();
  return scan.slam->counts().fused <= kTooFewToAgree ? map.mesh(0) : map.mesh();
}

std::string text_of(const RoomScan& scan) {
  const SlamCounts& counts = scan.slam->counts();
  std::string text = fmt::format("{} frames, {} fused, {} without a pose\n", scan.frames.size(),
                                 counts.fused, counts.lost);
  if (!scan.frames.empty()) text += text_of(scan.depth);
  if (scan.troubles.unreadable > 0) {
    text +=
        fmt::format("{} unreadable, the last: {}\n", scan.troubles.unreadable, scan.last_trouble);
  }
  if (scan.new_worlds > 0) {
    text += fmt::format("{} new world{} began: the surface holds what was seen since the last\n",
                        scan.new_worlds, scan.new_worlds == 1 ? "" : "s");
  }
  if (scan.loops > 0) {
    text += fmt::format("{} loop{} closed: {}\n", scan.loops, scan.loops == 1 ? "" : "s",
                        scan.again ? "fused once more along the corrected way"
                                   : "the surface holds what was seen since the last");
  }
  return text;
}

}  // namespace palpable
