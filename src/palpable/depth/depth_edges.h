/// @file
/// Depth at the border between near and far.
#pragma once

#include "palpable/geometry/image.h"

namespace palpable {

/// Makes unknown (NaN) both of two 4-neighbours whose depths differ by more than `share` of the
/// nearer one. At a jump a matcher's window, or a time-of-flight pixel, mixes near and far, and the
/// result lies between them: harmless in a picture, but it would press a body. One pixel on each
/// side of the jump is lost, so this is for the copy that contact reads.
///
/// @param share    0.05 or more keeps slanted surfaces whole: at 0.3 m and f = 350 px a surface at
///                 80 degrees changes by 1.6 % per pixel
/// @param scratch  resized to the image; memory that a frame loop uses again
void forget_jumps(DepthImage& depth, double share, MaskImage& scratch);

}  // namespace palpable
