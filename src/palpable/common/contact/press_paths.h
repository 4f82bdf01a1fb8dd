/// @file
/// The positions of the skin of a body when a site is pressed: the table that the law of sites
/// looks up (design: "level over depth is strictly monotone and tabulated").
///
///   S  sites     L  levels of the body's level axis, level 0 included     n_s  points of site s
#pragma once

#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace palpable {

/// The points of the skin that move when one site is pressed, and their positions at each level of
/// that press.
struct SitePath {
  /// (n_s) the vertices of the patch, and every point of the skin that moves at level 1 at least a
  /// given share of what the patch's most moved vertex moves, in rising order. Points that move
  /// less cannot measure the press: a displacement of 1 mm of such a point would demand a press of
  /// many mm.
  std::vector<int> points;
  /// (3 x n_s L) m, body frame; point j at level l is column j L + l.
  Eigen::Matrix3Xf positions;
  Eigen::AlignedBox3f box;  ///< of all of them
  /// (L) m, rising: how far the patch's most moved vertex has moved at each level. (The press depth
  /// is the patch's mean, which is less.)
  Eigen::VectorXd farthest;
};

/// The level at which the site's most moved vertex has moved by `depth` (m): 0 .. the last level;
/// linear between samples.
[[nodiscard]] double level_that_moves(const SitePath& path, const Eigen::VectorXd& levels,
                                      double depth);

/// Evaluates the reduced model at every sample of the level axis, for all sites.
/// @param skin         of this body (skin_points.h), without its fixed points
/// @param least_share  in (0, 1]
[[nodiscard]] std::vector<SitePath> press_paths(const ReducedBody& body,
                                                std::span<const SkinPoint> skin,
                                                double least_share);

}  // namespace palpable
