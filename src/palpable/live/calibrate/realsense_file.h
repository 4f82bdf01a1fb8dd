/// @file
/// Calibrations of Intel RealSense cameras (D400) in the forms that their programs give:
///
///   JSON    the Viewer's "calibration data": baseline (mm, negative), and for each size
///           rectified.N.fx fy ppx ppy width height of the rectified infrared pictures. Those of
///           both eyes and of the depth are the same.
///   text    what `rs-enumerate-devices -c` prints: Intrinsic of "Depth", "Infrared 1" and
///           "Infrared 2" for each size, and Extrinsic from one to the other (m)
///
/// They hold for rectified pictures (Y8, Y8I, Z16), not for Y12I.
#pragma once

#include "palpable/live/calibrate/foreign_lens.h"

#include <string_view>

namespace palpable {

[[nodiscard]] bool is_realsense_json(const KeyedText& text);
[[nodiscard]] bool is_realsense_listing(std::string_view text);

/// The rectified infrared pair of a size.
/// @param width, height  px, of one eye; 0: the first size of 1280 x 720, 848 x 480, 640 x 480 and
/// the others that the file has
/// @return or a problem without the file's name: which sizes the file has, what it lacks
[[nodiscard]] Result<RectifiedStereo> stereo_of_realsense(const KeyedText& json, int width,
                                                          int height);
[[nodiscard]] Result<RectifiedStereo> stereo_of_realsense(std::string_view listing, int width,
                                                          int height);

/// The depth camera of a size.
[[nodiscard]] Result<DistortedCamera> depth_of_realsense(const KeyedText& json, int width,
                                                         int height);
[[nodiscard]] Result<DistortedCamera> depth_of_realsense(std::string_view listing, int width,
                                                         int height);

/// One camera as JSON: fx fy ppx ppy (or cx cy) width height, as pyrealsense2 prints them, or
/// Open3D's intrinsic_matrix (column by column). The keys may stand below others; of several
/// cameras it is that with "depth" in its keys.
[[nodiscard]] bool is_one_camera_json(const KeyedText& json);
[[nodiscard]] Result<DistortedCamera> camera_of_json(const KeyedText& json);

}  // namespace palpable
