/// @file
/// Where a body may be touched: sites spread over its skin (paper Fig. 15), or named ones.
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
  double lowest = 0;       ///< m, Z in the body frame: no site below
  int patch_distance = 2;  ///< edges from the middle of the patch to its rim
  SiteDirection direction = SiteDirection::kToCentre;
  Eigen::Vector3d given =
      -Eigen::Vector3d::UnitZ();  ///< read for kGiven; its length does not matter
  /// (V) of each vertex in the load: nodal areas. Empty: vertex_areas(), right for 4-node elements.
  Eigen::VectorXd areas = {};
};

/// `count` vertices. With kSalient: those of the largest salience(), one after the other, none
/// nearer to another than half the distance that `count` sites have when they are spread over the
/// candidates; where that leaves too few, two thirds of it, and so on.
///
/// With kSpread: vertices far apart: the first is the one farthest from the centre of mass, each
/// next the one farthest (straight line) from all before it; equal distances go to the lower
/// number, so the answer is the same every time. Only vertices at or above `lowest` whose patch is
/// free of the support are asked.
///
/// Each site comes with its patch, weights (nodal areas, summing to 1) and direction; its full load
/// is left at 0.
/// @param skin   watertight
/// @param fixed  (V) 1 where the support holds the vertex
/// @throws Error when fewer vertices than `count` may be sites
[[nodiscard]] std::vector<Site> choose_sites(const SurfaceMesh& skin,
                                             const std::vector<std::uint8_t>& fixed,
                                             const SiteSettings& settings);

/// (V) 1/m: how strongly the skin bulges or caves in around each vertex: the absolute value of its
/// mean curvature, from the angles between triangles (sum over edges of length * angle / 4 over the
/// area there), averaged over the patch by area. Of a sphere of radius r: 1 / r.
[[nodiscard]] Eigen::VectorXd salience(const SurfaceMesh& skin, int patch_distance);

/// The sites at these vertices, in this order; `count` and `lowest` are not read. A patch leaves
/// out vertices that the support holds, where a load would do nothing.
/// @throws Error for a vertex that the support holds
[[nodiscard]] std::vector<Site> sites_at(const SurfaceMesh& skin,
                                         const std::vector<std::uint8_t>& fixed,
                                         const std::vector<int>& vertices,
                                         const SiteSettings& settings);

}  // namespace palpable
