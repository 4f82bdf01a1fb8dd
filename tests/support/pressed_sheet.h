/// @file
/// An elastic sheet as a body of a TouchSolver, and a ball that presses it.
#pragma once

#include "palpable/common/response/touch_solver.h"
#include "tests/support/ball_gap.h"
#include "tests/support/elastic_sheet.h"

#include <Eigen/Core>

namespace palpable::test {

/// The gap to a ball above the sheet, whose lowest point is `depth` below the sheet's plane.
/// @param radius, depth, at  m
inline GapFunction ball_into_sheet(float radius, float depth,
                                   const Eigen::Vector3f& at = Eigen::Vector3f::Zero()) {
  return gap_to_ball(at + Eigen::Vector3f(0, 0, radius - depth), radius);
}

struct PressedSheet {
  ElasticSheet body;
  TouchSettings settings;
  PressedSheet() { settings.softness = 1e-6; }
  [[nodiscard]] TouchSolver solver() const {
    return {body.skin, body.fixed, body.tables, settings};
  }
};

}  // namespace palpable::test
