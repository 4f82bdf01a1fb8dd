/// @file
/// Where the camera is, from sightings of known points: robust least squares.
#pragma once

#include "palpable/live/track/sighting.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// A point whose place is known, and where it was seen.
struct PosePoint {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  Sighting seen;
  /// Weight beside its sigma, 0..1: lower for a point that has not yet proved to stand still.
  double trust = 1;
};

struct PoseFitSettings {
  double tukey = 5;  ///< sigmas; residuals beyond have no weight (Tukey's biweight)
  /// In the first step the limit is this many times as wide, because the start is a guess; it is
  /// halved from step to step.
  double first_width = 16;
  int steps = 12;  ///< at most
};

struct PoseFit {
  Rigid3 camera_from_world = Rigid3::Identity();
  int inliers = 0;           ///< points whose u, v lie within the Tukey limit
  double rms_sigma = 0;      ///< of the inliers' u and v, in their sigmas
  std::vector<char> inlier;  ///< (points), 0 or 1
  bool solved = false;       ///< false: fewer than 4 inliers, or they leave the pose open
};

/// argmin over poses of  sum_i trust_i [ rho(|du_i, dv_i| / sigma_i) + rho(dd_i / sigma_d,i) ],
/// rho Tukey's biweight (Beaton and Tukey 1974), by reweighted Gauss-Newton steps from `start`.
/// Points behind the camera do not count. Points that move together (on a hand) do not draw the
/// pose along, as long as their trust sums to less than that of the resting points within the first
/// limit.
/// @param fit  overwritten; its memory is used again
void fit_pose(const TrackCamera& camera, std::span<const PosePoint> points, const Rigid3& start,
              const PoseFitSettings& settings, PoseFit& fit);

}  // namespace palpable
