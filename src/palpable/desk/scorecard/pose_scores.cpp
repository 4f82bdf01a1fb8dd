#include "palpable/desk/scorecard/pose_scores.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/desk/clip_files/live_file.h"
#include "palpable/desk/clip_files/trajectory_file.h"
#include "palpable/desk/score/camera_scores.h"

#include <fmt/core.h>

#include <numbers>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

std::vector<StampedPose> found_poses(const fs::path& result, bool of_depth_camera) {
  if (!fs::is_directory(result)) return read_trajectory(result);
  std::vector<StampedPose> found = read_trajectory(result / "trajectory.txt");
  if (!of_depth_camera || !fs::exists(result / "live.json")) return found;
  if (const auto color_from_depth = read_live_file(result / "live.json").color_from_depth) {
    for (StampedPose& pose : found) {
      pose.world_from_camera = pose.world_from_camera * *color_from_depth;
    }
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
  const std::vector<StampedPose> found = found_poses(result, published.of == "depth camera");
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

std::string json_of(const PoseScores& scores) {
  Json json;
  json["format"] = scores.format;
  json["poses_of"] = scores.of;
  json["poses_published"] = scores.published;
  json["poses_found"] = scores.found;
  json["poses_matched"] = scores.matched;
  json["seconds"] = scores.seconds;
  json["path_m"] = scores.path_m;
  json["ate_mm"] = scores.ate_mm;
  json["rpe_mm"] = scores.rpe_mm;
  json["rpe_deg"] = scores.rpe_deg;
  json["end_error_percent"] = scores.end_error_percent;
  return json.dump(2);
}

std::string text_of(const PoseScores& scores) {
  std::string text;
  const auto line = [&](const char* what, const std::optional<double>& score, const char* unit,
                        int digits) {
    text += score ? fmt::format("{:<44}{:.{}f}{}\n", what, *score, digits, unit)
                  : fmt::format("{:<44}-\n", what);
  };
  text += fmt::format("{:<44}{} ({}, of the {})\n", "published poses", scores.published,
                      scores.format, scores.of);
  text += fmt::format("{:<44}{}\n", "found poses", scores.found);
  text += fmt::format("{:<44}{}\n", "  at the moment of a published one", scores.matched);
  line("time from the first of these to the last", scores.seconds, " s", 2);
  line("path in that time", scores.path_m, " m", 2);
  line("position, rms after alignment", scores.ate_mm, " mm", 1);
  line("motion over 1 s, rms", scores.rpe_mm, " mm", 1);
  line("rotation over 1 s, rms", scores.rpe_deg, " degrees", 3);
  line("end of the path, of its length", scores.end_error_percent, " %", 2);
  return text;
}

}  // namespace palpable
