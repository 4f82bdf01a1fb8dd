/// @file
/// Which contact points are enough for an object that is not sharp. Between points s apart an
/// object of radius R enters a flat skin by s^2 / (8 R): a pencil's tip needs points 2 mm apart, a
/// palm does with fewer, and the problem's cost grows with their square.
///
///   C  contact points
#pragma once

#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <span>
#include <vector>

namespace palpable {

/// (C) m, the level of each point. The points of level s or more cover the skin: every contact
/// point has one of them within s, on its own side of the body. The sets are nested: a point that a
/// flat object needs also serves a sharp one. 0: the point belongs to the finest set alone.
/// @param coarsest, finest  m: the largest and the smallest s, each 1/sqrt(2) of the one before
[[nodiscard]] std::vector<float> point_levels(const SurfaceMesh& skin,
                                              std::span<const SkinPoint> points, double coarsest,
                                              double finest);

}  // namespace palpable
