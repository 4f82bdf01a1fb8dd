/// @file
/// Depth of a stereo rig by our own matcher (stereo_matcher.h), with supervision of the row
/// alignment (row_watch.h).
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/live/depth/stereo_eyes.h"
#include "palpable/live/stereo/row_watch.h"
#include "palpable/live/stereo/stereo_matcher.h"

#include <optional>

namespace palpable {

/// One of DepthCamera's three cameras, and the default for stereo.
class CensusCamera {
 public:
  /// Returns a problem if the rig is not valid (StereoEyes), its disparities exceed the matcher's
  /// range, or settings.threads is too large.
  [[nodiscard]] static Result<CensusCamera> make(const FrameFormat& format,
                                                 const DepthSettings& settings);

  /// Fills those parts of `seen` that DepthCamera::see() does not fill.
  /// @param seen  its color and depth have their sizes already
  /// @return false, and `seen` unspecified, if the frame's images do not have the format's size
  bool measure(const Frame& frame, SeenFrame& seen, StageTimes& times);

  [[nodiscard]] const PinholeCamera& camera() const { return eyes_.rectified().camera; }
  [[nodiscard]] const PinholeCamera& depth_camera() const { return eyes_.matched().camera; }
  [[nodiscard]] const RectifiedStereo& rectified() const { return eyes_.rectified(); }
  [[nodiscard]] const DepthNoise& noise() const { return noise_; }

 private:
  CensusCamera(StereoEyes eyes, const DepthSettings& settings);
  void match(SeenFrame& seen);
  void watch_rows(SeenFrame& seen);
  void find_misfit(SeenFrame& seen) const;
  void find_rows(const SeenFrame& seen);
  void fill_depth(SeenFrame& seen) const;

  StereoEyes eyes_;
  DepthNoise noise_;
  double farthest_;
  StereoMatcher matcher_;
  MatchedPair pair_;
  std::optional<RowWatch> watch_;
  double row_correction_px_ = 0;
  bool fit_is_known_ = false;  // find_misfit() runs in the first frame only: it takes 50 ms
  int unmeasured_ = 0;         // successive frames in which the row watch could not measure
};

}  // namespace palpable
