/// @file
/// All that a body file holds for being touched anywhere, by anything, at several places at once.
///
///   V  vertices of the skin
#pragma once

#include "palpable/touch/compliance.h"
#include "palpable/touch/nonlinear_answer.h"
#include "palpable/touch/region.h"

#include <cstddef>
#include <vector>

namespace palpable {

struct TouchTables {
  ComplianceTable compliance;
  std::vector<RegionTable> regions;  ///< none: the linear answer alone
  CrossTable cross;
  double region_reach = 0.018;   ///< m, from a region's middle: loads that it answers for
  double point_spacing = 0.002;  ///< m, of contact points, see skin_points.h
};

/// How large the tables are.
[[nodiscard]] std::size_t bytes_of(const TouchTables& tables);

}  // namespace palpable
