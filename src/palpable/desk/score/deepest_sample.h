/// @file
/// The sample of triangles that lies deepest inside a capsule.
#pragma once

#include "palpable/common/geometry/capsule.h"

#include <Eigen/Core>

namespace palpable {

/// Distance of x to the capsule's surface, m, negative inside: the smallest |x - c| - r over the
/// capsule's balls (middle c, radius r). Exact, closed form.
[[nodiscard]] double distance_to(const Capsule& capsule, const Eigen::Vector3d& x);

/// m: neighbouring samples of a triangle are no farther apart.
inline constexpr double kSampleSpacing = 0.002;

/// Looks for it triangle by triangle.
///
/// The samples are the corners of all parts of a triangle that is halved along its edges until they
/// are kSampleSpacing long at most (4096 times at most: that ends with a file's triangle of a
/// kilometre). A pencil's tip that lies between three vertices is found so. Parts that cannot hold
/// a deeper sample than the deepest so far are left out.
class DeepestSample {
 public:
  /// @param capsule  must live as long as this
  /// @param from     m: only what lies deeper is found; negative to find what lies near outside
  DeepestSample(const Capsule& capsule, double from);

  /// @return whether the triangle holds a deeper sample than all before it
  bool look_at(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

  [[nodiscard]] double depth() const { return depth_; }  ///< m; `from` until one is found
  [[nodiscard]] const Eigen::Vector3d& point() const { return point_; }  ///< m; once one is found

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
