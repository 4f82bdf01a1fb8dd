/// @file
/// Chooses the sites at which a body is pressed: spread over its skin (paper Fig. 15), or named
/// ones.
///
///   V  vertices of the skin
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

/// Where the load of a site points.
enum class SiteDirection {
  kToCentre,     ///< to the centre of mass of the enclosed solid (paper Sec. 5.2)
  kAlongNormal,  ///< into the body, along the mean normal of the patch
  kGiven
};

enum class SiteChoice {
  kSpread,  ///< far apart
  kSalient  ///< where the skin is curved most (paper Sec. 3.4: salient features)
};

struct SiteSettings {
  SiteChoice choice = SiteChoice::kSpread;
  int count = 16;
  double lowest = 0;       ///< m, Z in the body frame below which no site is chosen
  int patch_distance = 2;  ///< edges from the middle of the patch to its rim
  SiteDirection direction = SiteDirection::kToCentre;
  Eigen::Vector3d given =
      -Eigen::Vector3d::UnitZ();  ///< read for kGiven; its length does not matter
  /// (V) m^2, the nodal areas that weight the vertices of a load. Empty: vertex_areas(), which are
  /// right for 4-node elements.
  Eigen::VectorXd areas = {};
};

/// Chooses `count` sites. With kSalient: vertices in the order of their salience(), each at least
/// half as far from the others as `count` sites spread evenly over the candidates are; where that
/// gives too few, the distance is lowered to two thirds until there are enough.
///
/// With kSpread: farthest points. The first is the vertex farthest from the centre of mass, each
/// next one the vertex farthest (straight line) from all before it; of equal distances the lower
/// vertex number wins, so the result is deterministic.
///
/// Candidates are the vertices at or above `lowest` whose patch has no vertex that the support
/// holds.
///
/// Each site comes with its patch, weights (nodal areas, summing to 1) and direction; its full load
/// is left at 0.
/// @param skin   watertight
/// @param fixed  (V) 1 where the support holds the vertex
/// @throws Error when fewer vertices than `count` may be sites
[[nodiscard]] std::vector<Site> choose_sites(const SurfaceMesh& skin,
                                             const std::vector<std::uint8_t>& fixed,
                                             const SiteSettings& settings);

/// (V) 1/m: how strongly the skin is curved around each vertex: the absolute value of its mean
/// curvature, from the angles between triangles (sum over edges of length * angle / 4, divided by
/// the vertex's area), averaged over the patch by area. For a sphere of radius r it is 1 / r.
[[nodiscard]] Eigen::VectorXd salience(const SurfaceMesh& skin, int patch_distance);

/// The sites at these vertices, in this order; `count` and `lowest` are not read. A patch leaves
/// out vertices that the support holds, where a load would do nothing.
/// @throws Error for a vertex that the support holds
[[nodiscard]] std::vector<Site> sites_at(const SurfaceMesh& skin,
                                         const std::vector<std::uint8_t>& fixed,
                                         const std::vector<int>& vertices,
                                         const SiteSettings& settings);

}  // namespace palpable
