/// @file
/// Bundle adjustment: poses of keyframes and places of points that agree best with all sightings.
///
/// Levenberg and Marquardt's method on the reduced camera system (Schur complement; Triggs et al.,
/// "Bundle adjustment - a modern synthesis", 2000, Sec. 6): points are eliminated one by one, what
/// remains is a dense system of 6 numbers per free pose.
///
///   P  poses    L  points    M  sightings
#pragma once

#include "palpable/track/sighting.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

struct BundleSighting {
  int pose = 0;   ///< 0..P-1
  int point = 0;  ///< 0..L-1
  Sighting seen;
};

struct BundleProblem {
  TrackCamera camera;
  std::vector<Rigid3> camera_from_world;  ///< (P)
  std::vector<char> fixed;                ///< (P) 1: stays; at least one, else the whole may drift
  std::vector<Eigen::Vector3d> x_in_world;  ///< (L)
  std::vector<BundleSighting> sightings;    ///< (M) sorted by point
};

struct BundleSettings {
  int steps = 10;  ///< at most
  /// Sigmas at which a residual r has half its weight: Cauchy's 1 / (1 + r^2 / c^2), which unlike
  /// Tukey's never gives up a point that a bad start made look wrong.
  double cauchy = 2.5;
  double converged = 1e-4;  ///< relative decrease of the cost that ends it
};

struct BundleResult {
  int steps = 0;          ///< that lowered the cost
  double first_cost = 0;  ///< sum of Cauchy's c^2/2 log(1 + r^2/c^2) over u,v and d
  double last_cost = 0;
};

/// Improves the problem's free poses and all its points in place. What nothing measures (the depth
/// of a point with a single sighting without disparity) stays as it is. Costs about 1 microsecond
/// per sighting and step.
/// @throws ContractViolation when indices are out of range or sightings are not sorted by point
BundleResult adjust_bundle(BundleProblem& problem, const BundleSettings& settings = {});

/// Squared length of a sighting's u, v residual in sigmas; infinite behind the camera.
[[nodiscard]] double squared_residual(const BundleProblem& problem, const BundleSighting& sighting);

}  // namespace palpable
