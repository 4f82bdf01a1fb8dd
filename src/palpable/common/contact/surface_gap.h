/// @file
/// What the body is told of the things that press it.
#pragma once

#include <Eigen/Core>

#include <functional>

namespace palpable {

/// A place on the skin of another body that presses.
struct OtherSkin {
  int body = -1;                                      ///< a number that its solver knows; -1: none
  Eigen::Vector3i corners = Eigen::Vector3i::Zero();  ///< of its triangle
  Eigen::Vector3f weights = Eigen::Vector3f::Zero();  ///< of these
  /// m: how much farther away it is by the forces that press it now. Of a body that does not give
  /// way: 0
  float given_way = 0;
};

/// What is nearest to a place: the object that presses, as its signed distance.
struct SurfaceGap {
  float distance = 0;                                 ///< m, negative inside
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit, out of the object
  /// Second derivative of the distance, 1/m: a ball of radius r has (1 - n n^T) / r.
  Eigen::Matrix3f curvature = Eigen::Matrix3f::Zero();
  /// Of the point's own compliance, added to it, beside TouchSettings::softness: what is seen
  /// uncertainly presses softly.
  float softness = 0;
  OtherSkin on;  ///< of what it is, if it is another body
};

/// What a gap is at a place beside the one that it was told for, to second order.
struct GapBeside {
  float farther = 0;       ///< m, than there
  Eigen::Vector3f normal;  ///< unit
};
/// @param way  m, from the place that normal and curvature (SurfaceGap) were told for
[[nodiscard]] inline GapBeside gap_beside(const Eigen::Vector3f& normal,
                                          const Eigen::Matrix3f& curvature,
                                          const Eigen::Vector3f& way) {
  const Eigen::Vector3f turn = curvature * way;
  return {normal.dot(way) + 0.5f * way.dot(turn), (normal + turn).normalized()};
}

/// Tells the gap of a place (m, body frame); false where nothing is within kGapReach of it. What is
/// no number counts as nothing. Called some thousand times a frame.
using GapQuery = std::function<bool(const Eigen::Vector3f& place, SurfaceGap& gap)>;

/// Whether anything may be nearer to a place than `reach` (m): a cheaper question, asked first.
using NearQuery = std::function<bool(const Eigen::Vector3f& place, float reach)>;

inline constexpr float kGapReach = 0.012f;  ///< m

}  // namespace palpable
