/// @file
/// What is remembered of a touch from frame to frame.
///
///   W  nodes of the shell     V  the first of them: vertices that the tables know
#pragma once

#include "palpable/common/contact/point_forces.h"
#include "palpable/common/response/refinement.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// All that is remembered from frame to frame. The default is a body at rest.
struct TouchState {
  std::vector<PointForce> forces;
  std::vector<int> regions;  ///< that answered
  /// (3 x W) m, of what the tables know: the whole skin in the first V columns, then the inner
  /// nodes (shell_table.h), which are for the stress; no columns: at rest.
  Eigen::Matrix3Xf u;
  Refinement refinement;  ///< what exact answers have added
};

}  // namespace palpable
