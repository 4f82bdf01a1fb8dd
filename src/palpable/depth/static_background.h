/// @file
/// What was there before the hand came: learnt from the first frames, then taken out of every depth
/// image, so that the desk on which a body stands does not press it.
///
/// For a camera that does not move while it is learnt; later it may, if its motion is known.
#pragma once

#include "palpable/depth/depth_noise.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"

#include <vector>

namespace palpable {

struct StaticBackgroundSettings {
  int frames = 15;  ///< to learn from, 1 .. 255
  /// Depth counts as the background's when it is nearer by less than this many sigma: the sensor's
  /// own sigma_Z, or the pixel's own scatter while it was learnt if that is larger (at most
  /// thrice: a pixel between near and far scatters by their distance).
  double sigmas = 4;
  /// Half width of the window in which the background's nearest and farthest are looked up: a
  /// depth edge flickers by a pixel or two, and what it flickers between is all background.
  int edge_window_px = 2;
  /// A pixel must have had a depth in this share of the frames to be known.
  double seen_share = 0.25;
};

/// Per pixel the median of the depths that it had. A pixel that never had one stays unknown, and
/// whatever comes to lie there later is kept.
class StaticBackground {
 public:
  explicit StaticBackground(const DepthNoise& noise, const StaticBackgroundSettings& settings = {});

  /// Takes the next frame; the first fixes the size. After settings.frames it is ready and further
  /// frames change nothing.
  /// @throws ContractViolation when the size changes
  void learn(const DepthImage& depth);

  [[nodiscard]] bool ready() const { return learnt_ >= settings_.frames; }

  /// Sets to NaN what is background: Z >= Z_b - sigmas * sigma(Z_b), with the smallest such limit
  /// of all learnt depths Z_b within the window around the pixel. What is farther than the
  /// background is background too: a thing that was moved away uncovers what was always there.
  /// @throws ContractViolation before it is ready, or when the size differs
  void remove_static(DepthImage& depth) const;

  /// The same for a camera that has moved: the limits, as points of the room, are drawn into its
  /// view. Where the background has not been seen from where it was learnt, all is background;
  /// where it was seen but had no depth, it is taken to lie far away, and everything there is new.
  /// Costs about 10 ns per pixel.
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
