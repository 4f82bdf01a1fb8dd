/// @file
/// What is known of one moment once its depth was measured.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/depth/depth_watch.h"
#include "palpable/live/depth/pair_fit.h"

#include <limits>
#include <optional>

namespace palpable {

/// Depth and colour of one moment, both in the frame of the (rectified) left or of the colour
/// camera: a depth sensor that stands elsewhere is registered to it (depth_registration.h).
struct SeenFrame {
  int number = 0;
  double time = 0;  ///< s
  ColorImage color;
  PinholeCamera camera;  ///< of `color`
  GrayImage left;        ///< luma of `color`
  GrayImage left_half;   ///< the same at half the size; empty where stereo was not matched at that
  GrayImage right;       ///< luma of the right eye, rectified, as large; empty without a right eye
  DepthImage depth;      ///< Z in m, NaN unknown; half as large as `color` for stereo
  PinholeCamera depth_camera;
  /// 255 where something is nearer than the searched range (its depth is unknown); of the depth's
  /// size. Empty for a depth sensor and for OpenCV's matcher, which do not say.
  MaskImage too_close;
  /// How well a depth is known (disparity_filters.h), 0 where it is not; of the depth's size. Empty
  /// when the camera or OpenCV's matcher does not say.
  GrayImage confidence;
  /// Median row error of matched points in this frame, px of the full images, positive where the
  /// right image lies lower; NaN when too few points were matched or rows are not watched.
  double row_error_px = std::numeric_limits<double>::quiet_NaN();
  /// By how many px the right image's middle was moved up in this frame, beyond the calibration.
  double row_correction_px = 0;
  /// Share of the pixels of `depth` that have one or are marked as too close.
  double density = 0;
  /// What lasts and makes depth bad, this frame included (depth_watch.h).
  DepthTrouble trouble = DepthTrouble::kNone;
  /// Set in the first frame if its images do not fit the calibration (pair_fit.h; `rows_px` is of
  /// the full images): no later depth can then be trusted.
  std::optional<PairMisfit> misfit;
};

}  // namespace palpable
