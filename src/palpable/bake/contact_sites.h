/// @file
/// Where a body may be touched: sites spread over its skin (paper Fig. 15).
#pragma once

#include "palpable/geometry/surface_mesh.h"
#include "palpable/reduced/reduced_body.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct SiteSettings {
  int count = 16;
  double lowest = 0;       ///< m, Z in the body frame: no site below
  int patch_distance = 2;  ///< edges from the middle of the patch to its rim
};

/// `count` vertices far apart: the first is the one farthest from the centre of mass, each next the
/// one farthest (straight line) from all before it; equal distances go to the lower number, so the
/// answer is the same every time. Only vertices at or above `lowest` whose patch is free of the
/// support are asked.
///
/// Each site comes with its patch, weights (nodal areas, summing to 1) and direction, towards the
/// centre of mass of the enclosed solid (paper Sec. 5.2); its full load is left at 0.
/// @param skin   watertight
/// @param fixed  (V) 1 where the support holds the vertex
/// @throws Error when fewer vertices than `count` may be sites
[[nodiscard]] std::vector<Site> choose_sites(const SurfaceMesh& skin,
                                             const std::vector<std::uint8_t>& fixed,
                                             const SiteSettings& settings);

}  // namespace palpable
