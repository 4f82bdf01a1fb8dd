/// @file
/// How far measured depths scatter around the true one.
#pragma once

#include "palpable/geometry/camera.h"

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
};

/// Stereo: Z = f T / d gives sigma_Z = Z^2 / (f T) sigma_d. Pass the camera in which the disparity
/// was measured. 0.25 px at the matched resolution is what block matching scatters on textured,
/// still surfaces; the systematic part does not count here, since both depths have it.
[[nodiscard]] inline DepthNoise stereo_noise(const RectifiedStereo& matched,
                                             double sigma_disparity_px = 0.25) {
  return {0, 0, sigma_disparity_px / (matched.camera.fx_px * matched.baseline)};
}

/// Time of flight: phase noise grows with the returned light's inverse square root, that is with Z,
/// on top of a constant from the 1 mm steps and flying pixels; 2 mm + 0.5 % of Z covers the desk of
/// hands_squirrel (0.45-1.0 m), whose pixels scatter by 1-3 mm (depth_noise figures: the test
/// "a resting desk scatters less than the model says").
[[nodiscard]] inline DepthNoise time_of_flight_noise() { return {0.002, 0.005, 0}; }

}  // namespace palpable
