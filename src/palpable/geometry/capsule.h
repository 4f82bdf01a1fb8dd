/// @file
/// Capsules. Synthetic scenes build hands, pencils and cups of them.
///
/// Metres; the frame is the caller's.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// All balls whose centre lies between a and b and whose radius changes linearly from ra to rb: the
/// convex hull of the two spheres, a cone with rounded ends. When one sphere holds the other it is
/// the larger sphere.
struct Capsule {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double ra = 0;  ///< >= 0
  double rb = 0;  ///< >= 0
};

}  // namespace palpable
