/// @file
/// What presses a body: the list that crosses from contact to reconstruction, scene and files.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// One place where the real world presses the body. Contact hands over a list of these; at most one
/// is active at present, because answers of a nonlinear material do not add up (paper, below
/// Algorithm 1).
struct Touch {
  int site = 0;            ///< index into ReducedBody::sites
  double level = 0;        ///< (0, 1] of the site's full load: the paper's pseudo-time
  double force = 0;        ///< N, level * full_load
  double press_depth = 0;  ///< m, how far the site's patch is moved along its load
  Eigen::Vector3d point_in_body = Eigen::Vector3d::Zero();  ///< m, measured: where the surface is
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();      ///< unit, of the force; body frame
  double unseen_for = 0;  ///< s since what presses was measured (held_balls.h); 0: it is now
};

}  // namespace palpable
