/// @file
/// A camera's path against the one that a data set publishes of it.
#pragma once

#include "palpable/desk/clip_files/published_poses.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// By the names of docs/benchmark.md.
struct PoseScores {
  std::string format;  ///< of the published poses
  std::string of;      ///< whose they are
  int published = 0;   ///< poses
  int found = 0;       ///< poses of the result
  int matched = 0;     ///< found poses that have a published one within kSameMoment; two at least
  double seconds = 0;  ///< from the first matched pose to the last
  double path_m = 0;   ///< length of the published path through the matched poses
  double ate_mm = 0;   ///< root mean square after the best rigid alignment (trajectory_score.h)
  std::optional<double> rpe_mm;   ///< over 1 s
  std::optional<double> rpe_deg;  ///< over 1 s
  /// How far the way from the first to the last matched pose is off, in the first one's frame, in
  /// per cent of path_m; nothing where the camera stood.
  std::optional<double> end_error_percent;
};

/// s: farther apart are two moments, as TUM's own tool has it.
inline constexpr double kSameMoment = 0.02;

/// @param result  a file of TUM's format, or a folder that holds trajectory.txt; where its
/// live.json
///                tells a colour sensor of its own and the published poses are the depth camera's,
///                the found ones are brought to that
/// @throws Error when the result cannot be read, or fewer than two poses have a partner
[[nodiscard]] PoseScores score_poses(const PublishedPoses& published,
                                     const std::filesystem::path& result);

[[nodiscard]] std::string json_of(const PoseScores& scores);
[[nodiscard]] std::string text_of(const PoseScores& scores);

}  // namespace palpable
