/// @file
/// The camera's pose from sightings of known points, by robust least squares.
#pragma once

#include "palpable/live/track/sighting.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// A point of known position, and its sighting.
struct PosePoint {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  Sighting seen;
  /// Additional weight, 0..1: lower for a point that has not yet proved to be static.
  double trust = 1;
};

struct PoseFitSettings {
  double tukey = 5;  ///< sigma; limit beyond which residuals have no weight (Tukey's biweight)
  /// Factor on the limit in the first step, because the start is a guess. The factor is halved from
  /// step to step down to 1.
  double first_width = 16;
  int steps = 12;  ///< largest number of steps
};

struct PoseFit {
  Rigid3 camera_from_world = Rigid3::Identity();
  int inliers = 0;           ///< points whose u, v residual is within the Tukey limit
  double rms_sigma = 0;      ///< rms residual of the inliers' u and v, in units of their sigmas
  std::vector<char> inlier;  ///< (points), 0 or 1
  bool solved = false;       ///< false: fewer than 4 inliers, or they do not determine the pose
};

/// argmin over poses of  sum_i trust_i [ rho(|du_i, dv_i| / sigma_i) + rho(dd_i / sigma_d,i) ],
/// rho Tukey's biweight (Beaton and Tukey 1974), by reweighted Gauss-Newton steps from `start`.
/// Points behind the camera are ignored. Points that move together (on a hand) do not bias the
/// pose, as long as the sum of their trust is less than that of the static points within the first
/// limit.
/// @param fit  overwritten; its memory is reused
void fit_pose(const TrackCamera& camera, std::span<const PosePoint> points, const Rigid3& start,
              const PoseFitSettings& settings, PoseFit& fit);

}  // namespace palpable
