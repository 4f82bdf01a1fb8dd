/// @file
/// One ball of the union of balls that stands for seen obstacles.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// A ball of the union, with the position at which its obstacle was seen. Body frame.
struct ObjectBall {
  Eigen::Vector3f point;   ///< m, on the seen front
  Eigen::Vector3f normal;  ///< unit, outwards: to the camera's side
  Eigen::Vector3f centre;  ///< m
  float radius = 0.008f;   ///< m
  float sigma = 0;         ///< m, standard deviation of the measured surface
  float unseen_for = 0;    ///< s since it was measured; 0: in this frame
};

}  // namespace palpable
