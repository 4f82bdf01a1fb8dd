/// @file
/// What may press a body, as the contact solver sees it: a set of obstacles that tells the signed
/// distance of places, many in one call.
///
///     g(x) = distance of x from the nearest obstacle, m, negative inside it
///
/// Implemented by what a camera sees (pressing_surface.h), by capsules (capsule_obstacles.h), by
/// the skins of other bodies (yielding_skin.h, pressing_bodies.h), by what the full solver is
/// pressed by (touch_bake/touch_difference.h), and in tests by functions.
#pragma once

#include "palpable/common/contact/surface_gap.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// A contact point in front of another body's skin.
struct YieldingPoint {
  OtherSkin on;
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< of its force, in the pressed body's frame
};

/// Queries allocate nothing once as many places were asked before. Not to be asked by two threads
/// at a time.
class Obstacles {
 public:
  virtual ~Obstacles() = default;

  /// The gap of each place. Asked once an iteration of Newton's method, for all contact points that
  /// may press; before that place by place, to find these. What is no number counts as nothing.
  /// @param places  m, body frame
  /// @param gaps    as many, overwritten; SurfaceGap::distance is infinite where nothing is within
  ///                kGapReach
  virtual void find_gaps(std::span<const Eigen::Vector3f> places,
                         std::span<SurfaceGap> gaps) const = 0;

  /// Whether an obstacle may be nearer to a place than `reach` (m), which may exceed kGapReach: a
  /// cheaper question, asked first. True where that is not known.
  [[nodiscard]] virtual bool may_be_within(const Eigen::Vector3f& place, float reach) const = 0;

  /// Adds to W how much farther away each point's obstacle moves by a force of 1 N at each other
  /// point, along their normals: the compliance of what is pressed. By default nothing gives way.
  /// @param points  each with the SurfaceGap::on that find_gaps() wrote for its place
  /// @param W       (m x m) m/N, row by row; the lower triangle is read
  virtual void add_compliance(std::span<const YieldingPoint> points, std::span<double> W) const {
    (void)points;
    (void)W;
  }
};

/// The gap of one place.
[[nodiscard]] inline SurfaceGap gap_at(const Obstacles& obstacles, const Eigen::Vector3f& place) {
  SurfaceGap gap;
  obstacles.find_gaps({&place, 1}, {&gap, 1});
  return gap;
}

}  // namespace palpable
