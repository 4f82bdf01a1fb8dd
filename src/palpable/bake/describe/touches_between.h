/// @file
/// Vertices between the sites, where a touch is shown with the field of the nearest site (the error
/// of that: between_sites.h).
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace palpable {

/// Number of touches between sites that a campaign solves. A response of the bunny took 50 ms on a
/// busy core. The median of 100 errors whose quartiles are a factor of two apart is accurate to a
/// tenth.
inline constexpr int kTouchesBetween = 100;

struct NearestSite {
  std::size_t site = 0;                                       ///< position in the list of sites
  double distance = std::numeric_limits<double>::infinity();  ///< m, straight line
};

/// The nearest of the sites (vertices of the skin) that is not at `vertex` itself.
[[nodiscard]] NearestSite nearest_site(const SurfaceMesh& skin, const std::vector<int>& sites,
                                       int vertex);

/// Up to `most` of the vertices of `touchable` that lie between the sites, evenly spaced in that
/// list. A vertex lies between the sites if it is not a site and its distance (straight line) to
/// the nearest site is at most the largest distance of a site to its nearest neighbour. Empty for
/// fewer than two sites.
[[nodiscard]] std::vector<int> touches_between(const SurfaceMesh& skin,
                                               const std::vector<int>& sites,
                                               const std::vector<int>& touchable, int most);

}  // namespace palpable
