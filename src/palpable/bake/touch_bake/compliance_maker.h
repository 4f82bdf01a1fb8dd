/// @file
/// The compliance of every vertex of a skin as a table (response/compliance.h).
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/response/compliance.h"

namespace palpable {

struct ComplianceSettings {
  double spacing = 0.014;      ///< m: no vertex is farther from the middle of its cluster
  int most = 160;              ///< clusters; of a larger skin they are larger
  double near_radius = 0.028;  ///< m: clusters whose middles are nearer are near each other
  int rank = 32;               ///< k, a multiple of 16
  int threads = 1;
};

/// P of a cluster are the leading directions of what loads at vertices that are far from it,
/// spread over the skin, do in it, each field divided by its norm; for what is of higher order,
/// what they do in it in the first and second order. All else is computed for every component of
/// every vertex: 3V solves, 5 ms each on a body of 16,000 nodes. An inner node of the shell belongs
/// to the cluster of the vertex that is nearest to it.
[[nodiscard]] ComplianceTable make_compliance(const SkinResponse& skin,
                                              const ComplianceSettings& settings,
                                              const Progress& progress = {});

}  // namespace palpable
