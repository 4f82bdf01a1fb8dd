/// @file
/// What friction remembers of a contact point from frame to frame: its anchor.
///
///     x  contact point      a  anchor, a material point of what presses      X(a)  where it is now
///     s = P (x - X(a))      slip, m, in the tangent plane: P = 1 - n n^T
///
///     |t| < mu p            the point sticks: s + c t = 0, and the anchor stays where it is
///     |t| = mu p            it slides:  t = -mu p s' / |s'|, s' = s + c t, and the anchor follows:
///                           X(a) <- x + c t
///
/// with p the normal force, t the friction on the body (N), mu Coulomb's coefficient and c the
/// local compliance of the skin under the point (m/N), which the normal direction has as well. The
/// anchor of a point that sticks does not change at all, so that nothing creeps.
#pragma once

#include "palpable/common/geometry/skin_points.h"

#include <Eigen/Core>

#include <algorithm>
#include <span>

namespace palpable {

struct PointAnchor {
  int point = 0;  ///< index into SkinPointSet::points
  int by = -1;    ///< PointForce::by
  /// By an obstacle: which part of it (SurfaceGap::part) in the frame that the state is of.
  int part = -1;
  SkinPoint on;  ///< by another body: a place of its skin, with which the anchor moves
  /// m. By an obstacle: the anchor, body frame, at the obstacle's pose in the frame that the state
  /// is of. By another body: the anchor's offset from `on`, in that body's frame.
  Eigen::Vector3f place = Eigen::Vector3f::Zero();
  /// m, by an obstacle: how far the anchor came with it since the frame before. Used within a frame
  Eigen::Vector3f way = Eigen::Vector3f::Zero();
  bool presses = false;  ///< its point presses in the present step. Used within a frame
};

/// Whether one anchor comes before another in a state's list: as its forces do.
[[nodiscard]] inline bool anchored_before(const PointAnchor& a, const PointAnchor& b) {
  return a.point != b.point ? a.point < b.point : a.by < b.by;
}

/// The number of a contact point's anchor in a state's list; -1: it has none.
/// @param anchors  in order
[[nodiscard]] inline int number_of_anchor(std::span<const PointAnchor> anchors, int point, int by) {
  PointAnchor wanted;
  wanted.point = point;
  wanted.by = by;
  const auto at = std::lower_bound(anchors.begin(), anchors.end(), wanted, anchored_before);
  if (at == anchors.end() || anchored_before(wanted, *at)) return -1;
  return static_cast<int>(at - anchors.begin());
}

/// Friction of one contact within a step.
struct ContactFriction {
  float coefficient = 0;     ///< mu of this contact; 0: none
  bool is_anchored = false;  ///< without an anchor there is no friction
  bool is_new = false;       ///< the anchor was made in this step
  bool has_gap = false;      ///< `gap` is known
  bool slides = false;       ///< by the last iteration
  int number = -1;           ///< of its anchor in the state's list; -1: it has none there
  PointAnchor anchor;        ///< as the state has it
  /// m, body frame: what the obstacle has yet to come in this step of its way in the frame.
  Eigen::Vector3f to_come = Eigen::Vector3f::Zero();
  bool is_farther_back = false;  ///< the obstacle is in this step than when the frame began
  /// m, the anchor in the present step. By an obstacle: its place, body frame. By another body: its
  /// vector from the contact's foot, in that body's frame.
  Eigen::Vector3f held = Eigen::Vector3f::Zero();
  Eigen::Vector3f begun = Eigen::Vector3f::Zero();  ///< the point when the step began, likewise
  SkinPoint foot;  ///< by another body: the foot from which `held` and `begun` are measured
  /// By another body: the rotation from the contact's body to that one.
  Eigen::Matrix3f to_other = Eigen::Matrix3f::Identity();
  float gap = 0;         ///< m, when the step began, to the obstacle in the present step
  float compliance = 0;  ///< m/N, c
  /// m, before the present iteration: x - X(a), body frame. Some vector along the normal is in it.
  Eigen::Vector3f slip = Eigen::Vector3f::Zero();
};

/// Share of a step after which a gap closed: 0 to 1. The gap changes linearly.
/// @param before  m, at the begin of the step, to the obstacle where it was then; < 0 counts as 0
/// @param after   m, at the end of the step, if the point did not press
[[nodiscard]] inline float time_of_contact(float before, float after) {
  if (!(after < 0)) return 1;
  return before > 0 ? before / (before - after) : 0;
}

}  // namespace palpable
