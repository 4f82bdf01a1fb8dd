/// @file
/// What a live run senses, as pictures of the camera's size: how far away things are, and which of
/// them move.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/session/scene.h"

namespace palpable {

/// Depth in the colours of color_map.h, bright where it is near: shares of 1/Z between
/// kNearestShown and kFarthestShown. Grey where it is not known, red where something is too close
/// to be measured.
/// @param picture  overwritten, of the frame's size
void draw_depth(const Scene& scene, ColorImage& picture);

/// The frame, dark where nothing moves and orange where something does.
void draw_moving(const Scene& scene, ColorImage& picture);

inline constexpr Rgb kMovingColor{255, 120, 0};  ///< of what moves, in the map's picture too

inline constexpr double kNearestShown = 0.15, kFarthestShown = 2;  ///< m

}  // namespace palpable
