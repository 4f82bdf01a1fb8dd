/// @file
/// The common input of both stereo matchers: rectified images, and the range of disparities to
/// search.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/depth/seen_frame.h"

namespace palpable {

/// The two cameras ("eyes") of a raw or rectified rig. The resolution of matching is half of the
/// images', or the full one with settings.full_resolution or for images up to full_up_to_px.
class StereoEyes {
 public:
  /// Returns a problem if the numbers are not a valid rig or the images are too small to be
  /// matched.
  [[nodiscard]] static Result<StereoEyes> make(const FrameFormat& format,
                                               const DepthSettings& settings);

  /// Whether the frame's images have the format's size.
  [[nodiscard]] bool fits(const Frame& frame) const;

  /// Fills color, left, right and, if halved(), left_half of `seen`.
  /// @pre fits(frame)
  void rectify(const Frame& frame, SeenFrame& seen);

  /// The images to match, once the frame is rectified.
  [[nodiscard]] const GrayImage& left(const SeenFrame& seen) const {
    return halved() ? seen.left_half : seen.left;
  }
  [[nodiscard]] const GrayImage& right(const SeenFrame& seen) const {
    return halved() ? right_half_ : seen.right;
  }

  /// Turns the right eye by a small rotation from the next frame on (Rectification::turn_right).
  void turn_right(const Eigen::Matrix3d& turn) { rectification_.turn_right(turn); }

  /// The rectified rig at the size of the images, and at the resolution of matching.
  [[nodiscard]] const RectifiedStereo& rectified() const { return rectified_; }
  [[nodiscard]] const RectifiedStereo& matched() const { return matched_; }
  [[nodiscard]] bool halved() const { return halved_; }
  [[nodiscard]] DepthNoise noise() const { return stereo_noise(matched_); }

  /// The range of disparities, px of the matched images: disparities() of them, a multiple of 16,
  /// from first_disparity() on. It corresponds to depths from farthest() to settings.nearest.
  [[nodiscard]] double farthest() const { return farthest_; }  ///< m; depths beyond are unknown
  [[nodiscard]] int first_disparity() const { return first_disparity_; }
  [[nodiscard]] int disparities() const { return disparities_; }
  /// The largest disparity that settings.nearest needs; at most the end of the range.
  [[nodiscard]] int last_disparity() const { return last_disparity_; }

 private:
  StereoEyes(Rectification rectification, const FrameFormat& format, const DepthSettings& settings);
  void find_range(const DepthSettings& settings);

  int width_;   // px, of a frame's images
  int height_;  // px
  bool halved_;
  Rectification rectification_;
  RectifiedStereo rectified_;
  RectifiedStereo matched_;
  double farthest_;
  int first_disparity_ = 0;
  int disparities_ = 0;
  int last_disparity_ = 0;
  GrayImage right_half_;
};

}  // namespace palpable
