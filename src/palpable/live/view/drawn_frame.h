/// @file
/// A scene, and what drawing adds to it.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/view/figure_scores.h"

namespace palpable {

/// One frame, from what was seen to what is shown. Kept and filled again: its memory goes round.
struct DrawnFrame {
  Scene scene;
  /// Whether pictures, depth and masks of it are written; if not, nobody needs its masks.
  bool in_files = true;
  ColorImage picture;  ///< what is shown: of the camera's size, or the map's picture
  /// 255 where the picture shows the body, full size; filled in only for who draws masks.
  MaskImage visible;
  DepthImage body_depth;  ///< likewise: Z of the whole body (m), full size; NaN beside it
  FigureScores scores{};  ///< filled in only where somebody asks for them
};

}  // namespace palpable
