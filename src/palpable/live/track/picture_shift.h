/// @file
/// How far apart two poses are, as a picture shows it.
#pragma once

#include "palpable/live/track/sighting.h"

namespace palpable {

/// The largest distance, px, by which the middle of the picture and the four points a fifth away
/// from its sides move when the camera goes from pose a to pose b and everything lies `depth` m
/// away. 1e9 when one of them comes to lie behind the camera.
[[nodiscard]] double picture_shift_px(const TrackCamera& camera, double depth,
                                      const Rigid3& a_from_world, const Rigid3& b_from_world);

/// Nothing nearer to the camera than this is projected, m.
inline constexpr double kNearestSeen = 0.03;

}  // namespace palpable
