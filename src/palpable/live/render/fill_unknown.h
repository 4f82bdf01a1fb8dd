/// @file
/// Closes the holes of a depth image, so that there is a depth for occlusion everywhere near an
/// outline. A hole has one of two causes. Either only one eye sees the surface there, which is then
/// background; or the matcher has rejected its match, and the nearest known depth is a good guess.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"

#include <vector>

namespace palpable {

/// The longest run of pixels that counts as seen by one eye only. Beside a thing at 0.2 m before a
/// desk at 0.5 m, a stereo pair of 63 mm and 350 px has a run of 66 px; beside a hand at the body
/// it is 10 to 25 px.
inline constexpr int kLongestHalfSeen = 64;

/// Marks pixels of such runs in `nearest_in_row` below.
inline constexpr signed char kHalfSeen = 126;

/// Copies `box` of a depth image and closes its holes. An unknown pixel (NaN, infinite or not
/// positive) becomes
///
/// - the depth on its left, if it belongs to a run of at most kLongestHalfSeen unknown pixels of a
///   row, and the depth on the run's left is more than 1.1 times that on its right. The strip
///   directly left of a near thing is seen by the left eye alone, and is background:
///
///       far  ?  ?  ?  near     ->     far  far  far  far  near
///
/// - else the depth of the nearest known pixel of the box within `radius` pixels (Euclidean; of two
///   equally near, the farther depth), or 0 if there is none.
///
/// @param nearest_in_row  (box.height x box.width) row-major, overwritten: 0 where the depth was
///                        known, kHalfSeen where it is the far depth of the first rule, else
///                        another number. Pass the same vectors again and nothing is allocated
/// @param filled          (box.height x box.width) row-major, overwritten
/// @param borrowed  of the image's size, or null: not 0 where the depth was taken over from another
///                  pixel; such depths count as unknown
void fill_unknown(const DepthImage& depth, const MaskImage* borrowed, const PixelBox& box,
                  int radius, std::vector<signed char>& nearest_in_row, std::vector<float>& filled);

}  // namespace palpable
