/// @file
/// Places between the sites: where a touch is answered by the field of a site that lies elsewhere
/// (what that costs: between_sites.h).
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace palpable {

/// Touches between sites that a campaign solves. A response on the bunny took 50 ms of a busy core;
/// a median of so many errors, whose quartiles are a factor of two apart, is good to a tenth.
inline constexpr int kTouchesBetween = 100;

struct NearestSite {
  std::size_t site = 0;                                       ///< position in the list of sites
  double distance = std::numeric_limits<double>::infinity();  ///< m, straight line
};

/// The nearest of the sites (vertices of the skin) that is not at `vertex` itself.
[[nodiscard]] NearestSite nearest_site(const SurfaceMesh& skin, const std::vector<int>& sites,
                                       int vertex);

/// Up to `most` of the vertices of `touchable`, evenly from that list: those that lie between the
/// sites, i.e. are none themselves and no farther from the nearest one (straight line) than any
/// site is from its nearest neighbour. None with fewer than two sites.
[[nodiscard]] std::vector<int> touches_between(const SurfaceMesh& skin,
                                               const std::vector<int>& sites,
                                               const std::vector<int>& touchable, int most);

}  // namespace palpable
