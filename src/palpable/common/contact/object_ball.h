/// @file
/// One of the balls of which the object's surface is made.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// A ball of the union, with the place where its thing is seen. Body frame.
struct ObjectBall {
  Eigen::Vector3f point;   ///< m, on the seen front
  Eigen::Vector3f normal;  ///< unit, outwards: to the camera's side
  Eigen::Vector3f centre;  ///< m
  float radius = 0.008f;   ///< m
  float sigma = 0;         ///< m, of its surface where it was measured
  float unseen_for = 0;    ///< s since it was measured; 0: in this frame
};

}  // namespace palpable
