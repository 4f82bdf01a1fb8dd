/// @file
/// The factory calibration of a ZED camera: its vendor's text file SNxxxxxxxx.conf.
///
/// Sections LEFT_CAM_S and RIGHT_CAM_S hold fx fy cx cy (px) and k1 k2 p1 p2 k3; STEREO holds
/// Baseline TY TZ (mm; TY and TZ also as TY_S and TZ_S) and RX_S CV_S RZ_S, together one rotation
/// vector (rad), where CV is the rotation about y. S is 2K for eyes of 2208 x 1242 px, FHD
/// 1920 x 1080, HD 1280 x 720, VGA 672 x 376; of a ZED X FHD1200 1920 x 1200 and SVGA 960 x 600.
/// Keys are the same in capital and small letters; files of before 2018 have LEFT_CAM_RESOLUTION_S
/// and RX_RESOLUTION_S. A number may have a decimal comma. The sign of Baseline differs between the
/// vendor's own files: where it is positive all three are turned, so that the right eye is on the
/// right.
#pragma once

#include "palpable/live/calibrate/calibration_file.h"

namespace palpable {

/// The rig for images of this size (px, one eye). With width 0 the size is the first of HD, FHD, 2K
/// and VGA that the file contains.
///
/// Returns a problem that names the file if it cannot be read, has no section for this size (the
/// message lists the sizes that it has), lacks a number, or describes a rig that is not valid.
[[nodiscard]] Result<StereoCalibration> read_factory_calibration(const std::filesystem::path& path,
                                                                 int width, int height);

}  // namespace palpable
