/// @file
/// The obstacles of a body, as the contact solver sees them: a set that returns the signed
/// distances of positions, many in one call. Other bodies are not part of it.
///
///     g(x) = distance of x from the nearest obstacle, m, negative inside it
///
/// Implemented by the surface that a camera sees (pressing_surface.h), by capsules
/// (capsule_obstacles.h), by the obstacles of the full solver (touch_bake/touch_difference.h), and
/// in tests by functions.
#pragma once

#include "palpable/common/contact/surface_gap.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// Queries allocate nothing once as many positions were queried before. Not to be used by two
/// threads at a time.
class Obstacles {
 public:
  virtual ~Obstacles() = default;

  /// The gap of each position. Called once in each iteration of Newton's method, for all contacts;
  /// before that point by point, to find these. A gap that is not finite counts as no obstacle.
  /// @param places  m, body frame
  /// @param gaps    as many, overwritten; SurfaceGap::distance is infinite where nothing is within
  ///                kGapReach, or an implementation's shorter reach
  virtual void find_gaps(std::span<const Eigen::Vector3f> places,
                         std::span<SurfaceGap> gaps) const = 0;

  /// Whether an obstacle may be nearer to a position than `reach` (m), which may exceed kGapReach:
  /// a cheaper query, made first. True if that is not known.
  [[nodiscard]] virtual bool may_be_within(const Eigen::Vector3f& place, float reach) const = 0;
};

/// The gap of one position.
[[nodiscard]] inline SurfaceGap gap_at(const Obstacles& obstacles, const Eigen::Vector3f& place) {
  SurfaceGap gap;
  obstacles.find_gaps({&place, 1}, {&gap, 1});
  return gap;
}

}  // namespace palpable
