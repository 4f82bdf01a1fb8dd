/// @file
/// The scene before the hand came: learnt from the first frames, then removed from every depth
/// image, so that the desk on which a body stands does not press it.
///
/// The camera must not move while the scene is learnt; later it may, if its motion is known.
#pragma once

#include "palpable/depth/depth_noise.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"

#include <vector>

namespace palpable {

struct StaticBackgroundSettings {
  int frames = 15;  ///< to learn from, 1 .. 255
  /// A depth counts as the background's if it is nearer by less than this many sigma: the sensor's
  /// sigma_Z, or the pixel's own scatter while it was learnt if that is larger, but at most three
  /// times sigma_Z (a pixel between near and far scatters by their distance).
  double sigmas = 4;
  /// Half width of the window in which the background's nearest limit is looked up: a depth edge
  /// flickers by a pixel or two, and near and far side of it are both background.
  int edge_window_px = 2;
  /// A pixel must have had a depth in this share of the frames to be known.
  double seen_share = 0.25;
};

/// Per pixel the median of the depths that it had. A pixel that never had one stays unknown;
/// whatever appears there later is kept.
class StaticBackground {
 public:
  explicit StaticBackground(const DepthNoise& noise, const StaticBackgroundSettings& settings = {});

  /// Adds a frame; the first one fixes the size. After settings.frames of them the background is
  /// ready, and further ones change nothing.
  /// @throws ContractViolation when the size changes
  void learn(const DepthImage& depth);

  [[nodiscard]] bool ready() const { return learnt_ >= settings_.frames; }

  /// Sets to NaN what is background: Z >= Z_b - sigmas * sigma(Z_b), with the smallest such limit
  /// of all learnt depths Z_b within the window around the pixel. Everything behind that limit is
  /// background, too: if a thing is moved away, one sees what always stood behind it.
  /// @throws ContractViolation before it is ready, or when the size differs
  void remove_static(DepthImage& depth) const;

  /// The same for a camera that has moved: the limits are drawn into its view as points in space.
  /// A pixel that shows a place which the camera did not see while it learnt is background. A place
  /// that was seen but had no depth counts as infinitely far: everything there is new. About 10 ns
  /// per pixel.
  /// @param camera  of the depth images
  /// @param now_from_learnt  the camera's frame while it was learnt -> its frame now
  void remove_static(DepthImage& depth, const PinholeCamera& camera, const Rigid3& now_from_learnt);

  /// The learnt depth, NaN unknown; meaningful once ready.
  [[nodiscard]] const DepthImage& depth() const { return median_; }

 private:
  void finish();

  DepthNoise noise_;
  StaticBackgroundSettings settings_;
  int learnt_ = 0;
  std::vector<DepthImage> seen_;  ///< emptied once ready
  DepthImage median_;
  DepthImage keep_below_;  ///< depth below which a pixel is new; infinity where unknown
  DepthImage moved_;       ///< keep_below_ as a camera that has moved sees it
};

}  // namespace palpable
