/// @file
/// Where the skin of a body goes when a site is pressed: the table that the default contact law
/// looks up (design: "level over depth is strictly monotone and tabulated").
///
///   S  sites     L  levels of the body's level axis, level 0 included     n_s  vertices of site s
#pragma once

#include "palpable/reduced/reduced_body.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The vertices that follow one site, and their deformed positions.
struct SitePath {
  /// (n_s) the patch, and every vertex that moves at level 1 at least a given share of what the
  /// patch's most moved vertex moves. Vertices that move less cannot measure the press: to move one
  /// by 1 mm the site would have to be pressed by many.
  std::vector<int> vertices;
  /// (3 x n_s L) m, body frame; vertex j at level l is column j L + l.
  Eigen::Matrix3Xf positions;
};

/// Evaluates the reduced model at every sample of the level axis, for all sites.
/// @param least_share  in (0, 1]
[[nodiscard]] std::vector<SitePath> press_paths(const ReducedBody& body, double least_share);

}  // namespace palpable
