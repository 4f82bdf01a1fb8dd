/// @file
/// Pictures of a live run's sensed depth and moving mask, of the camera's size.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/session/scene.h"

namespace palpable {

/// Draws depth in the colours of color_map.h, on a scale that is linear in 1/Z from kFarthestShown
/// (dark) to kNearestShown (bright). Grey where the depth is not known, red where something is too
/// close to be measured.
/// @param picture  overwritten, of the frame's size
void draw_depth(const Scene& scene, ColorImage& picture);

/// Draws the frame, darkened where nothing moves and orange where something does.
void draw_moving(const Scene& scene, ColorImage& picture);

inline constexpr Rgb kMovingColor{255, 120, 0};  ///< of moving pixels; also in the map's picture

inline constexpr double kNearestShown = 0.15, kFarthestShown = 2;  ///< m

}  // namespace palpable
