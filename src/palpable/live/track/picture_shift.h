/// @file
/// The distance between two poses, measured as a shift of the picture in px.
#pragma once

#include "palpable/live/track/sighting.h"

namespace palpable {

/// The largest distance, px, by which five points of the picture move when the camera goes from
/// pose a to pose b and the scene is at a depth of `depth` m. The points are the picture's middle
/// and four at a fifth of its width and height from its sides. 1e9 if one of them moves behind the
/// camera.
[[nodiscard]] double picture_shift_px(const TrackCamera& camera, double depth,
                                      const Rigid3& a_from_world, const Rigid3& b_from_world);

/// Points with a smaller Z than this are not projected, m.
inline constexpr double kNearestSeen = 0.03;

}  // namespace palpable
