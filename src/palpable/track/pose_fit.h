/// @file
/// Where the camera is, from sightings of known points: robust least squares.
#pragma once

#include "palpable/track/sighting.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// A point whose place is known, and where it was seen.
struct PosePoint {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  Sighting seen;
  /// How much it is trusted beyond its sigma, 0..1: less for points that have not proved still.
  double trust = 1;
};

struct PoseFitSettings {
  /// Residuals beyond so many sigma have no weight (Tukey's biweight).
  double tukey = 5;
  /// In the first steps the limit is this many times as wide, because the start is a guess; it is
  /// halved from step to step.
  double first_width = 16;
  int steps = 12;
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
/// Points behind the camera do not count. A group of points that moves together and is smaller, in
/// trust, than the resting ones within the first limit does not draw the pose.
/// @param fit  overwritten; its memory is used again
void fit_pose(const TrackCamera& camera, std::span<const PosePoint> points, const Rigid3& start,
              const PoseFitSettings& settings, PoseFit& fit);

}  // namespace palpable
