/// @file
/// The state of a body with tables between frames.
///
///   W  nodes of the shell     V  the first of them: vertices of the tables
#pragma once

#include "palpable/common/contact/point_anchor.h"
#include "palpable/common/contact/point_forces.h"
#include "palpable/common/response/inertia.h"
#include "palpable/common/response/refinement.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// All that is carried from frame to frame. The default is a body at rest.
struct TouchState {
  std::vector<PointForce> forces;
  std::vector<PointAnchor> anchors;  ///< of the points with friction; none without friction
  std::vector<int> regions;          ///< of the patches
  /// (3 x W) m, displacement: of the whole skin in the first V columns, then of the inner nodes
  /// (shell_table.h), which only the stress needs. No columns: at rest.
  Eigen::Matrix3Xf u;
  Refinement refinement;     ///< corrections by full-order solutions
  VibrationState vibration;  ///< at rest unless time passes (ContactSolver::advance())
};

}  // namespace palpable
