/// @file
/// What a touch solver is told of the other bodies that press its own, each of which is answered by
/// a solver of its own (contact/pressing_bodies.h).
#pragma once

#include "palpable/common/contact/surface_gap.h"
#include "palpable/common/response/compliance.h"

#include <Eigen/Core>

#include <functional>
#include <span>

namespace palpable {

/// A contact point before another body's skin.
struct YieldingPoint {
  OtherSkin on;
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< of its force, in the pressed body's frame
};

/// Adds to W how much farther away each of these points' obstacles is by a force of 1 N at each
/// other one, along their normals. @param W  (m x m) m/N, row by row; the lower triangle is asked
using YieldQuery = std::function<void(std::span<const YieldingPoint> points, std::span<double> W)>;

struct OtherBodies {
  YieldQuery yields;  ///< empty: what presses does not give way
  /// Forces of bodies on this one, N, its frame: no unknowns. At vertices that the tables know,
  /// each at most once; at most TouchSolver::kMostGiven, whose number is the caller's business.
  std::span<const VertexForce> given;
};

}  // namespace palpable
