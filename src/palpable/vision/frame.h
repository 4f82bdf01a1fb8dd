/// @file
/// What a camera hands over: plain images and, once, what they mean.
///
/// Camera frame: X right, Y down, Z forward, m. Pixel (0, 0) is the centre of the first pixel.
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"

namespace palpable {

/// One moment as the source saw it. A stereo source fills left and right (raw, or rectified if its
/// format says so) and leaves depth empty; a colour + depth source fills left and depth.
struct Frame {
  int number = 0;   ///< position in the source, from 0; a frame that was skipped leaves a gap
  double time = 0;  ///< s since the source's first frame
  ColorImage left;
  ColorImage right;
  DepthImage depth;  ///< Z in m, NaN unknown; pixel for pixel the view of `left`
};

/// What all frames of one source have in common.
struct FrameFormat {
  enum class Kind { kStereo, kColorDepth };
  Kind kind = Kind::kStereo;
  int width = 0;   ///< px, of each colour image and of the depth
  int height = 0;  ///< px
  /// kStereo with already_rectified == false: both lenses and how they stand to each other.
  StereoRig rig;
  bool already_rectified = false;
  RectifiedStereo rectified;   ///< kStereo with already_rectified == true
  PinholeCamera depth_camera;  ///< kColorDepth: the one view that colour and depth share
};

/// Raw pairs of a rig, as large as its left eye's images.
[[nodiscard]] inline FrameFormat format_of(const StereoRig& rig) {
  FrameFormat format;
  format.width = rig.left.pinhole.width;
  format.height = rig.left.pinhole.height;
  format.rig = rig;
  return format;
}

}  // namespace palpable
