/// @file
/// A scene and its picture.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/view/figure_scores.h"

namespace palpable {

/// The results of one frame. Reused for the next frame, so that no memory is allocated.
struct DrawnFrame {
  Scene scene;
  /// Whether pictures, depth and masks are written to files; if not, no masks are needed.
  bool in_files = true;
  ColorImage picture;  ///< of the camera's size, or the picture of another view
  /// 255 where the picture shows the body, full size; filled in only if masks are drawn.
  MaskImage visible;
  DepthImage body_depth;  ///< likewise: Z of the whole body (m), full size; NaN beside it
  FigureScores scores{};  ///< filled in only on request
};

}  // namespace palpable
