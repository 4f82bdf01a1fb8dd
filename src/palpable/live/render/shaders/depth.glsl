// Depths of body and real surface. Every z is metric: Z in the camera frame, m. Window depth
// appears in one function and is never compared with a metric depth.
// Also compiled as C++ (color_map_test.cpp).

/// Window depth of the point at Z = z: 1 at the near plane, 0 at infinity. Reversed, because a
/// float's digits lie near 0: at Z = 1 m the step is 6e-8 of Z.
float window_depth(float z, float near) { return near / z; }

#include "occlusion_bias.glsl"

/// Share of the body at depth body_z that is hidden by a real surface at depth real_z: 0 up to the
/// bias, 1 beyond twice the bias, smooth between, so that noise does not flicker. real_z = 0 means
/// unknown and hides nothing.
float hidden_share(float body_z, float real_z) {
  if (!(real_z > 0.0f)) return 0.0f;
  float bias = occlusion_bias(body_z);
  return smoothstep(bias, 2.0f * bias, body_z - real_z);
}
