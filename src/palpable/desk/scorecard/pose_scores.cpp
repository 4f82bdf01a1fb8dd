#include "palpable/desk/scorecard/pose_scores.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/score/camera_scores.h"

#include <fmt/core.h>

#include <numbers>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// live.json of the result; empty if it is a file or has none.
LiveFile live_file_of(const fs::path& result) {
  return fs::exists(result / "live.json") ? read_live_file(result / "live.json") : LiveFile();
}

std::vector<StampedPose> found_poses(const fs::path& result, const LiveFile& live,
                                     bool of_depth_camera) {
  if (!fs::is_directory(result)) return read_trajectory(result);
  std::vector<StampedPose> found = read_trajectory(result / "trajectory.txt");
  if (!of_depth_camera || !live.color_from_depth) return found;
  for (StampedPose& pose : found) {
    pose.world_from_camera = pose.world_from_camera * *live.color_from_depth;
  }
  return found;
}

std::string span_of(const std::vector<StampedPose>& poses) {
  if (poses.empty()) return "no pose";
  return fmt::format("{:.3f} to {:.3f} s", poses.front().time, poses.back().time);
}

// The translation from the first to the last camera pose, in the frame of the first.
Eigen::Vector3d travel(const Rigid3& first, const Rigid3& last) {
  return (first.inverse() * last).translation();
}

}  // namespace

PoseScores score_poses(const PublishedPoses& published, const fs::path& result) {
  const LiveFile live = live_file_of(result);
  const std::vector<StampedPose> found = found_poses(result, live, published.of == "depth camera");
  // Each found pose gets a published one, because data sets publish several poses per frame.
  std::vector<PosePair> pairs;
  for (const StampedPose& pose : found) {
    if (const auto truth = pose_nearest(published.poses, pose.time, kSameMoment)) {
      pairs.push_back({pose.time, *truth, pose.world_from_camera});
    }
  }
  if (pairs.size() < 2) {
    throw Error(fmt::format(
        "{}: {} of its {} poses has a published one within {} s: published are {}, found {}. Files "
        "without times take --fps",
        result.string(), pairs.size(), found.size(), kSameMoment, span_of(published.poses),
        span_of(found)));
  }
  PoseScores scores;
  scores.speed = live.speed;
  scores.format = published.format;
  scores.of = published.of;
  scores.published = static_cast<int>(published.poses.size());
  scores.found = static_cast<int>(found.size());
  scores.matched = static_cast<int>(pairs.size());
  scores.seconds = pairs.back().time - pairs.front().time;
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    scores.path_m += (pairs[k].truth.translation() - pairs[k - 1].truth.translation()).norm();
  }
  const TrajectoryScore score = score_trajectory(pairs);
  scores.ate_mm = 1e3 * score.ate;
  if (score.rpe) {
    scores.rpe_mm = 1e3 * *score.rpe;
    scores.rpe_deg = *score.rpe_angle * 180 / std::numbers::pi;
  }
  if (scores.path_m > 0) {
    const Eigen::Vector3d off = travel(pairs.front().truth, pairs.back().truth) -
                                travel(pairs.front().found, pairs.back().found);
    scores.end_error_percent = 100 * off.norm() / scores.path_m;
  }
  return scores;
}

}  // namespace palpable
