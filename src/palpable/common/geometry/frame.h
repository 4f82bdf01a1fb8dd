/// @file
/// The output of a source: frames of plain images, and one description that holds for all frames.
///
/// Camera frame: X right, Y down, Z forward, m. Pixel (0, 0) is the centre of the first pixel.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <optional>
#include <utility>

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

  friend bool operator==(const ColorSensor& a, const ColorSensor& b) {
    return a.camera == b.camera && a.color_from_depth.matrix() == b.color_from_depth.matrix();
  }
};

/// What all frames of one source have in common.
struct FrameFormat {
  enum class Kind { kStereo, kColorDepth };
  Kind kind = Kind::kStereo;
  int width = 0;   ///< px, of each colour image; of the depth see depth_size_of()
  int height = 0;  ///< px
  /// s, time of the recording's own clock at the frame of time 0; other programs match files by it.
  /// 0 if the recording has no clock.
  double starts_at = 0;
  /// kStereo with already_rectified == false: both lenses and their relative pose.
  StereoRig rig;
  bool already_rectified = false;
  RectifiedStereo rectified;   ///< kStereo with already_rectified == true
  PinholeCamera depth_camera;  ///< kColorDepth
  /// kColorDepth: the separate colour sensor; nothing if colour and depth share one view and one
  /// size.
  std::optional<ColorSensor> color_sensor;
  /// kColorDepth: m, the step of the whole numbers in which the source delivers depths, as decided
  /// when it was opened. 0: not known (the source delivers metres, or is a recording of 0.1).
  double depth_unit = 0;
  bool depth_unit_assumed = false;  ///< neither the user nor a file, layout or device stated it
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

/// Width and height of the depth images, px: those of the depth camera, which has fewer pixels than
/// the colour camera in a phone; of the colour images where it states none.
[[nodiscard]] inline std::pair<int, int> depth_size_of(const FrameFormat& format) {
  const PinholeCamera& camera = format.depth_camera;
  if (camera.width > 0 && camera.height > 0) return {camera.width, camera.height};
  return {format.width, format.height};
}

/// The distance of the eyes, m; empty for colour + depth and for a format without a calibration.
[[nodiscard]] inline std::optional<double> baseline_of(const FrameFormat& format) {
  if (format.kind != FrameFormat::Kind::kStereo) return std::nullopt;
  const double baseline = format.already_rectified
                              ? format.rectified.baseline
                              : format.rig.right_from_left.translation().norm();
  if (baseline == 0) return std::nullopt;
  return baseline;
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
