/// @file
/// Stereo calibrations as OpenCV YAML, the format that its calibration programs write.
///
/// Entries: image_width, image_height; K1 K2 (3 x 3, px; skew 0), D1 D2 (k1 k2 p1 p2 [k3], 4 or 5
/// numbers, or up to 14 of which the further ones are 0), R (3 x 3) and T (3, m) with
/// x_right = R x_left + T; fps is optional. For pairs that are rectified already: fx fy cx cy,
/// width, height, baseline_m, doffs_px (0 if absent; Middlebury's: x_R - x_L at infinity), fps.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/live/calibrate/calibration_check.h"

#include <filesystem>
#include <string>

namespace palpable {

/// The content of a rig's file; both images have the same size.
struct StereoCalibration {
  StereoRig rig;
  double frames_per_second = 30;
  bool rate_is_stated = true;  ///< false: the file has no fps
};

/// The content of a file for images that are already rectified.
struct RectifiedCalibration {
  RectifiedStereo stereo;
  double frames_per_second = 30;
  bool rate_is_stated = true;  ///< false: the file has no fps
};

/// Reads and checks a file (calibration_check.h). For any content, the result is a valid rig or a
/// problem that names the file. R is replaced by the nearest rotation, so that rounding in the text
/// has no effect.
[[nodiscard]] Result<StereoCalibration> read_stereo_calibration(const std::filesystem::path& path);
[[nodiscard]] Result<RectifiedCalibration> read_rectified_calibration(
    const std::filesystem::path& path);

/// The same for a text that was read already. @param path  of the file, for messages
[[nodiscard]] Result<StereoCalibration> stereo_calibration_of(const std::string& text,
                                                              const std::filesystem::path& path);
[[nodiscard]] Result<RectifiedCalibration> rectified_calibration_of(
    const std::string& text, const std::filesystem::path& path);

/// These write all digits, so that reading gives the same numbers again.
/// @throws ContractViolation if the calibration is not valid; Error if the file cannot be written
void write_stereo_calibration(const std::filesystem::path& path,
                              const StereoCalibration& calibration);
void write_rectified_calibration(const std::filesystem::path& path,
                                 const RectifiedCalibration& calibration);

}  // namespace palpable
