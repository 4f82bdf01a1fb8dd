/// @file
/// Bridges small gaps of a depth image within a surface, so that the depths around them can be
/// joined to a surface.
#pragma once

#include "palpable/common/geometry/image.h"

namespace palpable {

/// The largest ratio of neighbouring depths of one surface.
inline constexpr float kSurfaceJump = 1.06F;

/// How far from an unknown pixel depths are searched, px.
inline constexpr int kBridgeReach = 2;

/// Gives an unknown pixel the depth of the surface around it: on each of the four lines through it
/// (along the row, the column and the diagonals) the nearest depths within kBridgeReach on both
/// sides are joined with 1/Z linear along the line, which is exact on planes. The lines that have a
/// depth on both sides are averaged. A pixel stays unknown if no line has two, or if any two of the
/// depths found differ by more than kSurfaceJump: then an edge lies there. Known pixels are copied.
///
/// Where a third of the pixels is missing at random, nearly all are bridged; a gap that is wider
/// than 2 kBridgeReach - 1 in all directions keeps its middle.
///
/// @param depth    Z in m, NaN (or not positive) unknown
/// @param bridged  overwritten, of the same size; NaN unknown. Allocates if it has another size.
void bridge_gaps(const DepthImage& depth, DepthImage& bridged);

}  // namespace palpable
