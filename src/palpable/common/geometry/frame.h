/// @file
/// The output of a source: frames of plain images, and one description that holds for all frames.
///
/// Camera frame: X right, Y down, Z forward, m. Pixel (0, 0) is the centre of the first pixel.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <optional>

namespace palpable {

/// The images of one instant. A stereo source fills left and right (raw, or rectified if its format
/// says so) and leaves depth empty; a colour + depth source fills left and depth. A camera that
/// sends both eyes side by side in YUYV fills `both` and leaves left and right empty: converting
/// the images before rectification would cost twice as much.
struct Frame {
  int number = 0;   ///< position in the source, from 0; a frame that was skipped leaves a gap
  double time = 0;  ///< s since the source's first frame
  ColorImage left;
  ColorImage right;
  YuyvImage both;    ///< (height x width) pairs of pixels: left eye, then right eye, in each row
  DepthImage depth;  ///< Z in m, NaN unknown; of the format's depth camera
};

/// A colour sensor that has its own lens and is mounted beside the depth sensor.
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
  /// s, time of the recording's own clock at the frame of time 0; other programs match files by it.
  /// 0 if the recording has no clock.
  double starts_at = 0;
  /// kStereo with already_rectified == false: both lenses and their relative pose.
  StereoRig rig;
  bool already_rectified = false;
  RectifiedStereo rectified;   ///< kStereo with already_rectified == true
  PinholeCamera depth_camera;  ///< kColorDepth
  /// kColorDepth: the separate colour sensor; nothing if colour and depth share one view.
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
