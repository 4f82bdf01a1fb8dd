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

#include <filesystem>
#include <string>

namespace palpable {

/// What a rig's file says; both images have the same size.
struct StereoCalibration {
  StereoRig rig;
  double frames_per_second = 30;
};

/// The same for images whose rows are aligned already.
struct RectifiedCalibration {
  RectifiedStereo stereo;
  double frames_per_second = 30;
};

/// What is wrong with a rig, in one line without a file's name: numbers that are not finite, sizes
/// or focal lengths that are not positive, a distortion that no lens has, a rotation that is not
/// one
/// (|R^T R - I| > 1e-3 in an entry, or det R < 0), a baseline that is not within 1 mm .. 10 m (a
/// file in millimetres is a common slip), eyes that do not stand side by side or look more than 40
/// degrees apart. Empty when nothing is wrong.
[[nodiscard]] std::string what_is_wrong_with(const StereoRig& rig);
[[nodiscard]] std::string what_is_wrong_with(const RectifiedStereo& stereo);

/// Reads and checks. Whatever the bytes are, the result is a sound rig or a problem that names the
/// file. R is replaced by the nearest rotation, so that round-off in the text does no harm.
[[nodiscard]] Result<StereoCalibration> read_stereo_calibration(const std::filesystem::path& path);
[[nodiscard]] Result<RectifiedCalibration> read_rectified_calibration(
    const std::filesystem::path& path);

/// Write all digits, so that reading gives the same numbers again.
/// @throws ContractViolation when the calibration is not sound; Error when the file cannot be
/// written
void write_stereo_calibration(const std::filesystem::path& path,
                              const StereoCalibration& calibration);
void write_rectified_calibration(const std::filesystem::path& path,
                                 const RectifiedCalibration& calibration);

}  // namespace palpable
