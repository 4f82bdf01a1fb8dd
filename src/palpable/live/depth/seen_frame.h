/// @file
/// A camera frame with its depth.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/depth/depth_watch.h"
#include "palpable/live/depth/measured_depth.h"
#include "palpable/live/depth/pair_fit.h"

#include <limits>
#include <optional>

namespace palpable {

/// Depth and colour of one instant, both in the view of the (rectified) left or of the colour
/// camera. The depth of a separate depth sensor is transformed to that view (depth_registration.h).
struct SeenFrame {
  int number = 0;
  double time = 0;  ///< s
  ColorImage color;
  PinholeCamera camera;  ///< of `color`
  GrayImage left;        ///< luma of `color`
  GrayImage left_half;   ///< the same at half the size; empty unless stereo was matched at it
  GrayImage right;       ///< luma of the right camera, rectified, same size; empty if there is none
  DepthImage depth;      ///< Z in m, NaN unknown; half as large as `color` for stereo
  PinholeCamera depth_camera;
  /// 255 where something is nearer than the searched range (its depth is unknown); of the depth's
  /// size. Empty for a depth sensor and for OpenCV's matcher, which do not provide it.
  MaskImage too_close;
  /// Confidence of a depth (disparity_filters.h), 0 where it is unknown; of the depth's size. Empty
  /// for a depth sensor and for OpenCV's matcher, which do not provide it.
  GrayImage confidence;
  /// Median row error of matched points in this frame, px of the full images, positive where the
  /// right image lies lower; NaN if too few points were matched or rows are not watched.
  double row_error_px = std::numeric_limits<double>::quiet_NaN();
  /// Shift of the right image's middle upwards in this frame, in addition to the calibration, px.
  double row_correction_px = 0;
  /// Share of the pixels that have a depth or are marked as too close.
  double density = 0;
  MeasuredDepth measured;  ///< before limits left out a part
  /// A persistent trouble that degrades depth, including this frame (depth_watch.h).
  DepthTrouble trouble = DepthTrouble::kNone;
  /// Set in the first frame if its images do not fit the calibration (pair_fit.h; `rows_px` is of
  /// the full images): no later depth can then be trusted.
  std::optional<PairMisfit> misfit;
};

}  // namespace palpable
