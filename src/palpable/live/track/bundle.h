/// @file
/// Bundle adjustment: finds the poses of keyframes and the positions of points that agree best with
/// all sightings.
///
/// Levenberg and Marquardt's method on the reduced camera system (Schur complement; Triggs et al.,
/// "Bundle adjustment - a modern synthesis", 2000, Sec. 6): points are eliminated one by one, and a
/// dense system of 6 numbers per free pose remains.
///
///   P  poses    L  points    M  sightings
#pragma once

#include "palpable/live/track/sighting.h"

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
  std::vector<char> fixed;  ///< (P) 1: not changed; at least one, or all may drift together
  std::vector<Eigen::Vector3d> x_in_world;  ///< (L)
  std::vector<BundleSighting> sightings;    ///< (M) sorted by point
};

struct BundleSettings {
  int steps = 10;  ///< largest number of steps
  /// c, sigma: a residual r has Cauchy's weight 1 / (1 + r^2 / c^2), which is 1/2 at c. Unlike
  /// Tukey's weight it is never 0, so a point that starts with a large error can still converge.
  double cauchy = 2.5;
  bool measure_disparity_error = false;  ///< BundleResult::disparity_error_px; costs one step
  double converged = 1e-4;  ///< the adjustment ends when the relative decrease of cost is smaller
};

struct BundleResult {
  int steps = 0;          ///< number of steps that lowered the cost
  double first_cost = 0;  ///< sum of Cauchy's c^2/2 log(1 + r^2/c^2) over u,v and d
  double last_cost = 0;
  /// The disparity error (TrackCamera) that would fit best, estimated by one step from the result
  /// with all poses and points free to follow, and its inverse variance, 1/px^2. 0: not determined,
  /// or not asked for.
  double disparity_error_px = 0;
  double disparity_information = 0;
};

/// Improves the problem's free poses and all its points in place. Quantities that no sighting
/// measures (the depth of a point that was seen once, without disparity) do not change. Takes about
/// 1 microsecond per sighting and step.
/// @throws ContractViolation when indices are out of range or sightings are not sorted by point
BundleResult adjust_bundle(BundleProblem& problem, const BundleSettings& settings = {});

/// Squared length of a sighting's (u, v) residual, in units of its sigma; infinite for a point
/// behind the camera.
[[nodiscard]] double squared_residual(const BundleProblem& problem, const BundleSighting& sighting);

}  // namespace palpable
