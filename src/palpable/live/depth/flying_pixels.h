/// @file
/// Pixels of a depth sensor that lie in mid-air.
///
/// Where a pixel sees the edge of a near thing and the room behind it, a sensor states a depth
/// between both, at which nothing is:
///
///     near   o o o o
///                    x        x: a flying pixel
///                      x
///     far                o o o o
///
/// Such a pixel has a much nearer pixel on one side and a much farther one on the opposite side. So
/// has a surface that is seen nearly edge-on; its depths are as unreliable.
#pragma once

#include "palpable/common/geometry/image.h"

namespace palpable {

/// The steepest surface that stays: the depth changes by this number of pixels' widths from one
/// pixel to the next, 84 degrees off the view.
inline constexpr float kSteepestSurface = 10;

/// Copies a depth image without its flying pixels. Pixel p with depth Z is one if, in a row, a
/// column or a diagonal, one neighbour is nearer and the opposite one is farther, each by more than
/// kSteepestSurface Z / f times the distance of both pixels (1 or sqrt 2 px). A neighbour without
/// depth is neither; pixels of the image's border stay.
///
/// @param depth     Z in m; zero, negative or NaN: unknown
/// @param f_px      focal length, > 0
/// @param farthest  m; what is farther becomes unknown
/// @param kept      overwritten, of the same size: Z in m, NaN unknown
void leave_out_flying_pixels(const DepthImage& depth, float f_px, float farthest, DepthImage& kept);

}  // namespace palpable
