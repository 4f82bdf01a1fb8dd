/// @file
/// Arrows drawn on a picture: forces on a body.
#pragma once

#include "palpable/common/geometry/image.h"

#include <Eigen/Core>

namespace palpable {

/// Draws an arrow with soft edges and a dark rim, so that it is visible on light and dark pictures.
/// Parts outside of the picture are cut off; nothing is drawn unless both ends are finite.
/// @param tail, tip  px, from the centre of the picture's first pixel
/// @param width      px, of the shaft, > 0; the head is three times as wide. An arrow that is
///                   shorter than its head has no shaft
void draw_arrow(ColorImage& picture, const Eigen::Vector2f& tail, const Eigen::Vector2f& tip,
                float width, Rgb color);

}  // namespace palpable
