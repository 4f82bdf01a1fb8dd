/// @file
/// The synthetic desk's cameras: a rig with the numbers of a real one.
#pragma once

#include "palpable/geometry/camera.h"

#include <cstdint>

namespace palpable {

/// A ZED Mini at 1280 x 720, numbers of the factory file SN10027514.conf (section HD): baseline
/// 63.02 mm, f about 700 px, barrel distortion of 110 px in the corners, eyes that are 3 mrad from
/// parallel and 10 px apart in their principal points' rows.
[[nodiscard]] StereoRig zed_mini_rig();

/// What the rig's images have that its calibration does not say.
struct SensorFaults {
  double noise_grey_levels = 0.65;  ///< standard deviation of the luma before it is rounded (0.71
                                    ///< after: rounding adds 1/sqrt 12)
  double right_gain = 1.0;          ///< of the right eye against the left, linear
  double vignetting = 0.22;         ///< light lost in a corner of the picture
  /// How far the true right image lies below what the calibration says.
  double row_error_px = 0.0;
};

/// Faults of the rig number `seed`: gain within 3 %, row error within 0.1 px; not all zero.
[[nodiscard]] SensorFaults sensor_faults(std::uint64_t seed);

}  // namespace palpable
