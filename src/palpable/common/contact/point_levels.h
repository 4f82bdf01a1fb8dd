/// @file
/// Which contact points are enough for an obstacle of a given curvature. Between points s apart an
/// obstacle of radius R enters a flat skin by s^2 / (8 R): a pencil's tip needs points 2 mm apart,
/// a palm needs fewer, and the cost of the contact problem grows with the square of their number.
///
///   C  contact points
#pragma once

#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <span>
#include <vector>

namespace palpable {

/// (C) m, the level of each point. The points of level s or more cover the skin: every contact
/// point has one of them within s, on its own side of the body. The sets are nested: the points for
/// a flat obstacle are among those for a sharp one. 0: the point belongs to the finest set alone.
/// @param coarsest, finest  m: the largest and the smallest s, each 1/sqrt(2) of the one before
[[nodiscard]] std::vector<float> point_levels(const SurfaceMesh& skin,
                                              std::span<const SkinPoint> points, double coarsest,
                                              double finest);

}  // namespace palpable
