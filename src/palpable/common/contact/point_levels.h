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

/// (C) m, of each point: in the set of all points whose number is `s` or more each other point of
/// the skin has one within s, on its own side of the body. The sets are nested: a point that a flat
/// object needs is there for a sharp one, too. 0 of those that only the finest set has.
/// @param coarsest, finest  m: the largest and the smallest s, each 1/sqrt(2) of the one before
[[nodiscard]] std::vector<float> point_levels(const SurfaceMesh& skin,
                                              std::span<const SkinPoint> points, double coarsest,
                                              double finest);

}  // namespace palpable
