/// @file
/// A ball as what touches, exactly.
#pragma once

#include "palpable/common/contact/touch_solver.h"

#include <Eigen/Core>

namespace palpable::test {

/// @param centre, radius  m
/// @param reach           m: nothing is told farther from it, nor in its very middle
inline GapQuery gap_to_ball(const Eigen::Vector3f& centre, float radius, float reach = kGapReach) {
  return [=](const Eigen::Vector3f& x, SurfaceGap& gap) {
    const Eigen::Vector3f way = x - centre;
    const float distance = way.norm();
    gap.distance = distance - radius;
    if (!(gap.distance < reach) || distance == 0.0f) return false;
    gap.normal = way / distance;
    gap.curvature = (Eigen::Matrix3f::Identity() - gap.normal * gap.normal.transpose()) / distance;
    return true;
  };
}

}  // namespace palpable::test
