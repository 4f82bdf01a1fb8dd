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
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< N, t, body frame
  /// N, t when the frame began, from which the step limit interpolates. Used within a frame
  Eigen::Vector3f force_before = Eigen::Vector3f::Zero();
};

/// Whether one anchor comes before another in a state's list: as its forces do.
[[nodiscard]] inline bool anchored_before(const PointAnchor& a, const PointAnchor& b) {
  return a.point != b.point ? a.point < b.point : a.by < b.by;
}

/// N, friction at a contact point of a state; 0 where it has no anchor. @param anchors  in order
[[nodiscard]] inline Eigen::Vector3f friction_at(std::span<const PointAnchor> anchors, int point,
                                                 int by) {
  PointAnchor wanted;
  wanted.point = point;
  wanted.by = by;
  const auto at = std::lower_bound(anchors.begin(), anchors.end(), wanted, anchored_before);
  if (at == anchors.end() || anchored_before(wanted, *at)) return Eigen::Vector3f::Zero();
  return at->force;
}

/// Friction of one contact within a frame.
struct ContactFriction {
  float given = 0;           ///< SurfaceGap::friction
  int part = -1;             ///< SurfaceGap::part
  float coefficient = 0;     ///< mu of this contact; 0: none
  bool is_begun = false;     ///< `begun` is known,
  bool has_gap = false;      ///< and `gap`
  bool is_anchored = false;  ///< without an anchor there is no friction
  bool is_new = false;       ///< the anchor was made in this step
  bool slides = false;       ///< by the last iteration
  PointAnchor anchor;        ///< as the state has it
  /// m, the anchor in the present step. By an obstacle: its place, body frame. By another body: its
  /// vector from the contact's foot, in that body's frame.
  Eigen::Vector3f held = Eigen::Vector3f::Zero();
  Eigen::Vector3f begun = Eigen::Vector3f::Zero();  ///< the point when the step began, likewise
  /// By another body: the rotation from the contact's body to that one.
  Eigen::Matrix3f to_other = Eigen::Matrix3f::Identity();
  float gap = 0;         ///< m, when the step began, to the obstacle in the present step
  float own_way = 0;     ///< m, by which the point's own force moves it along the normal: W_ii p
  float compliance = 0;  ///< m/N, c
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< N, t on the body, body frame
};

/// Share of a step after which a gap closed: 0 to 1. The gap changes linearly.
/// @param before  m, at the begin of the step, to the obstacle where it was then; < 0 counts as 0
/// @param own_way  m, ContactFriction::own_way: without the point's force the gap would end at
///                 minus this
[[nodiscard]] inline float time_of_contact(float before, float own_way) {
  const float gap = before > 0 ? before : 0;
  const float all = gap + own_way;
  return all > 0 ? gap / all : 0;
}

}  // namespace palpable
