/// @file
/// Comparison of a camera's path with the path that a data set publishes.
#pragma once

#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/live_file.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// Scores named as in docs/benchmark.md.
struct PoseScores {
  std::string format;  ///< of the published poses
  std::string of;      ///< whose poses they are, as in PublishedPoses
  int published = 0;   ///< number of published poses
  int found = 0;       ///< number of poses of the result
  int matched = 0;     ///< found poses with a published one within kSameMoment; >= 2
  double seconds = 0;  ///< from the first matched pose to the last
  double path_m = 0;   ///< length of the published path through the matched poses
  double ate_mm = 0;   ///< root mean square after the best rigid alignment (camera_scores.h)
  std::optional<double> rpe_mm;   ///< over 1 s
  std::optional<double> rpe_deg;  ///< over 1 s
  /// Error of the translation from the first to the last matched pose, in the frame of the first,
  /// in % of path_m; nothing when the camera did not move.
  std::optional<double> end_error_percent;
  RunSpeed speed;  ///< of live.json beside trajectory.txt
};

/// s; poses farther apart in time do not match. The value of TUM's own tool.
inline constexpr double kSameMoment = 0.02;

/// @param result  a file in TUM's format, or a folder that holds trajectory.txt. If its live.json
///                has color_from_depth and the published poses are those of the depth camera, the
///                found poses are converted to the depth camera
/// @throws Error when the result cannot be read, or when fewer than two poses match
[[nodiscard]] PoseScores score_poses(const PublishedPoses& published,
                                     const std::filesystem::path& result);

}  // namespace palpable
