/// @file
/// The standard deviation of measured depths.
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
  /// The same in single precision, for loops over pixels.
  [[nodiscard]] float sigma_in_float(float depth) const {
    return static_cast<float>(constant) +
           depth * (static_cast<float>(linear) + depth * static_cast<float>(quadratic));
  }
};

/// Stereo: Z = f T / d gives sigma_Z = Z^2 / (f T) sigma_d. `matched` is the camera in which the
/// disparity was measured. On textured, static surfaces block matching has a standard deviation of
/// 0.25 px at the matched resolution. Systematic errors are not included, because they are the same
/// in the depths that are compared with each other.
[[nodiscard]] inline DepthNoise stereo_noise(const RectifiedStereo& matched,
                                             double sigma_disparity_px = 0.25) {
  return {0, 0, sigma_disparity_px / (matched.camera.fx_px * matched.baseline)};
}

/// Time of flight: the returned light falls with Z^2, and the phase noise grows accordingly; the
/// constant is due to the depth's resolution of 1 mm. Fitted to the recording hands_squirrel, to be
/// slightly above the medians of its static pixels, whose standard deviation is 0.4 mm at 0.45 m,
/// 2.2 mm at 1.25 m and 8 mm at 2.4 m (one pixel in ten: twice that).
[[nodiscard]] inline DepthNoise time_of_flight_noise() { return {0.0007, 0, 0.0013}; }

}  // namespace palpable
