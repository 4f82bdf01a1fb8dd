/// @file
/// How far measured depths scatter around the true one.
#pragma once

#include "palpable/common/geometry/camera.h"

namespace palpable {

/// Standard deviation of a depth at Z, as a polynomial: m, 1, 1/m.
///
///     sigma_Z(Z) = constant + linear Z + quadratic Z^2
struct DepthNoise {
  double constant = 0;
  double linear = 0;
  double quadratic = 0;

  [[nodiscard]] double sigma(double depth) const {
    return constant + depth * (linear + depth * quadratic);
  }
  /// The same to a float's rounding, for loops over pixels.
  [[nodiscard]] float sigma_in_float(float depth) const {
    return static_cast<float>(constant) +
           depth * (static_cast<float>(linear) + depth * static_cast<float>(quadratic));
  }
};

/// Stereo: Z = f T / d gives sigma_Z = Z^2 / (f T) sigma_d. Pass the camera in which the disparity
/// was measured. Block matching scatters by 0.25 px at the matched resolution on textured, still
/// surfaces; systematic errors do not count here, since two depths that are compared both have
/// them.
[[nodiscard]] inline DepthNoise stereo_noise(const RectifiedStereo& matched,
                                             double sigma_disparity_px = 0.25) {
  return {0, 0, sigma_disparity_px / (matched.camera.fx_px * matched.baseline)};
}

/// Time of flight: the returned light fades with Z^2, and the phase noise grows as it fades; the
/// steps of 1 mm are the constant. Fitted to the recording hands_squirrel, whose resting pixels
/// scatter by 0.4 mm at 0.45 m, 2.2 mm at 1.25 m, 8 mm at 2.4 m (medians; one pixel in ten by twice
/// that): a little above its medians.
[[nodiscard]] inline DepthNoise time_of_flight_noise() { return {0.0007, 0, 0.0013}; }

}  // namespace palpable
