/// @file
/// What a source delivers: frames of plain images, and one description of all its frames.
///
/// Camera frame: X right, Y down, Z forward, m. Pixel (0, 0) is the centre of the first pixel.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/yuyv.h"

#include <optional>

namespace palpable {

/// One moment as the source saw it. A stereo source fills left and right (raw, or rectified if its
/// format says so) and leaves depth empty; a colour + depth source fills left and depth. A camera
/// that sends both eyes side by side in YUYV fills `both` and leaves left and right empty: what is
/// converted before it is rectified costs twice.
struct Frame {
  int number = 0;   ///< position in the source, from 0; a frame that was skipped leaves a gap
  double time = 0;  ///< s since the source's first frame
  ColorImage left;
  ColorImage right;
  YuyvImage both;    ///< (height x width) pairs of pixels: left eye, then right eye, in each row
  DepthImage depth;  ///< Z in m, NaN unknown; of the format's depth camera
};

/// A colour sensor with a lens of its own, at another place than the depth sensor.
struct ColorSensor {
  PinholeCamera camera;
  Rigid3 color_from_depth = Rigid3::Identity();  ///< translation in m
};

/// What all frames of one source have in common.
struct FrameFormat {
  enum class Kind { kStereo, kColorDepth };
  Kind kind = Kind::kStereo;
  int width = 0;   ///< px, of each colour image and of the depth
  int height = 0;  ///< px
  /// s: when the frame of time 0 was taken by the recording's own clock, for files that other
  /// programs join by it; 0 where the recording has none.
  double starts_at = 0;
  /// kStereo with already_rectified == false: both lenses and how they stand to each other.
  StereoRig rig;
  bool already_rectified = false;
  RectifiedStereo rectified;   ///< kStereo with already_rectified == true
  PinholeCamera depth_camera;  ///< kColorDepth
  /// kColorDepth with a colour sensor of its own; nothing: colour and depth share one view.
  std::optional<ColorSensor> color_sensor;
};

/// Sets the size of the images, for formats whose file does not state it.
inline void set_size(FrameFormat& format, int width, int height) {
  format.width = format.depth_camera.width = width;
  format.height = format.depth_camera.height = height;
  if (format.color_sensor) {
    format.color_sensor->camera.width = width;
    format.color_sensor->camera.height = height;
  }
}

/// The format of a rig's raw pairs; images have the size of the left eye's.
[[nodiscard]] inline FrameFormat format_of(const StereoRig& rig) {
  FrameFormat format;
  format.width = rig.left.pinhole.width;
  format.height = rig.left.pinhole.height;
  format.rig = rig;
  return format;
}

}  // namespace palpable
