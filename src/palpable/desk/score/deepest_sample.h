/// @file
/// The sample of triangles that lies deepest inside a capsule.
#pragma once

#include "palpable/common/geometry/capsule.h"

#include <Eigen/Core>

namespace palpable {

/// Distance of x to the capsule's surface, m, negative inside: the smallest |x - c| - r over the
/// capsule's balls (middle c, radius r). Exact, closed form.
[[nodiscard]] double distance_to(const Capsule& capsule, const Eigen::Vector3d& x);

/// m, largest distance of neighbouring samples of a triangle.
inline constexpr double kSampleSpacing = 0.002;

/// Searches the deepest sample triangle by triangle.
///
/// A triangle is split at the middles of its edges, recursively, until the edges of the parts are
/// at most kSampleSpacing long; the samples are the corners of the parts. So a pencil's tip between
/// the vertices of a triangle is found, too. An edge is split into at most 4096 parts, which bounds
/// the cost for huge triangles in a wrong file. Parts that cannot hold a sample deeper than the
/// deepest one so far are skipped.
class DeepestSample {
 public:
  /// @param capsule  must outlive this object
  /// @param from     m; only deeper samples are found. A negative value also finds samples outside
  ///                 the capsule that are this near to it
  DeepestSample(const Capsule& capsule, double from);

  /// @return whether the triangle holds a deeper sample than all triangles before it
  bool look_at(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

  [[nodiscard]] double depth() const { return depth_; }  ///< m; `from` until a sample is found
  [[nodiscard]] const Eigen::Vector3d& point() const {
    return point_;
  }  ///< m; valid once a sample is found

 private:
  void halve(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
             int halvings);
  [[nodiscard]] bool misses_box(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c) const;

  const Capsule& capsule_;
  Eigen::Array3d low_, high_;
  double depth_;
  Eigen::Vector3d point_ = Eigen::Vector3d::Zero();
};

}  // namespace palpable
