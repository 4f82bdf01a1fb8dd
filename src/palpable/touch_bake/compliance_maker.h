/// @file
/// The compliance of every vertex of a skin as a table (touch/compliance.h).
#pragma once

#include "palpable/base/progress.h"
#include "palpable/touch/compliance.h"
#include "palpable/touch_bake/skin_response.h"

#include <Eigen/Core>

namespace palpable {

struct ComplianceSettings {
  int rank = 304;              ///< modes of the whole body, a multiple of 16
  double near_radius = 0.025;  ///< m: what the modes leave is kept between vertices so near
  int threads = 1;
};

/// The modes are the leading directions of what loads at single vertices, spread over the skin, do
/// beyond the near radius: that is all that the modes have to answer for. What they leave within it
/// is computed for every component of every vertex: 3V solves, 5 ms each on a body of 16,000 nodes.
[[nodiscard]] ComplianceTable make_compliance(const SkinResponse& skin,
                                              const ComplianceSettings& settings,
                                              const Progress& progress = {});

}  // namespace palpable
