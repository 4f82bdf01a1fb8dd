/// @file
/// The stereo rig of the synthetic desk: its calibration, and the deviations of its images from it.
#pragma once

#include "palpable/common/geometry/camera.h"

#include <cstdint>

namespace palpable {

/// A ZED Mini at 1280 x 720 with the numbers of the factory file SN10027514.conf (section HD):
/// baseline 63.02 mm, f about 700 px, barrel distortion of 110 px in the corners, optical axes 3
/// mrad from parallel, and a difference of 10 px between the rows of the principal points.
[[nodiscard]] StereoRig zed_mini_rig();

/// Deviations of the rig's images from those of a perfect rig with its calibration.
struct SensorFaults {
  /// Standard deviation of the luma before rounding. Rounding adds a variance of 1/12, so that 0.65
  /// becomes 0.71.
  double noise_grey_levels = 0.65;
  double right_gain = 1.0;    ///< linear gain of the right eye relative to the left
  double vignetting = 0.22;   ///< share of the light that is lost in a corner of the image
  double row_error_px = 0.0;  ///< px, how much lower the right image lies than calibrated
};

/// The faults of one rig: a gain error of 1.5 to 2.9 % and a row error of 0.05 to 0.09 px. No rig
/// is free of faults, so that every method is tested with them.
[[nodiscard]] SensorFaults sensor_faults(std::uint64_t seed);

}  // namespace palpable
