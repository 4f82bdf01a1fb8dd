/// @file
/// Rigid transforms, named target_from_source: x_in_world = world_from_camera * x_in_camera. Poses
/// that were corrected, measured several times, or follow each other in time.
#pragma once

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Rotation and translation (m) that maps points of the source frame into the target frame;
/// always named target_from_source.
using Rigid3 = Eigen::Isometry3d;

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< rad
inline constexpr double kTurn = 2.0 * std::numbers::pi;      ///< rad, a full turn

/// When a loop is closed, the poses of earlier keyframes change. Things that were placed in the
/// world by the old poses are moved by one correction for each keyframe.
struct Correction {
  int keyframe = 0;  ///< number of its frame
  /// Maps a point that was placed by this keyframe's drifted pose to its corrected position.
  Rigid3 world_from_drifted = Rigid3::Identity();
};

/// The correction for things that were placed in frame `number`: that of the last keyframe up to
/// this frame, or that of the first keyframe if there is none.
/// @param corrections  at least one, their numbers rising
[[nodiscard]] inline const Rigid3& correction_at(std::span<const Correction> corrections,
                                                 int number) {
  PALPABLE_EXPECT(!corrections.empty(), "something was corrected");
  const auto after = std::upper_bound(corrections.begin(), corrections.end(), number,
                                      [](int n, const Correction& c) { return n < c.keyframe; });
  return (after == corrections.begin() ? after : after - 1)->world_from_drifted;
}

/// A robust mean of several measurements of one pose. Takes the pose whose distances to all others
/// have the smallest sum, and returns the mean of the half of the poses (rounded up) that are
/// nearest to it. Almost half of the poses may be outliers.
/// @param poses  at least one
/// @param reach  m: a rotation of 1 rad counts as this distance. It is the distance from the origin
///               of the source frame at which points matter
[[nodiscard]] Rigid3 median_pose(std::span<const Rigid3> poses, double reach);

/// A camera's pose with its time.
struct StampedPose {
  double time = 0;  ///< s
  Rigid3 world_from_camera = Rigid3::Identity();
};

/// The pose whose time is nearest to `time`, the later one of two that are equally near.
/// @param path    in order of time
/// @param within  s: nothing is returned if the nearest pose is farther away in time
[[nodiscard]] std::optional<Rigid3> pose_nearest(const std::vector<StampedPose>& path, double time,
                                                 double within);

}  // namespace palpable
