// Depths of bodies and real surfaces. Every z is metric: Z in the camera frame, m. Window depth
// is computed by one function and is never compared with a metric depth.
// Also compiled as C++ (color_map_test.cpp).

/// Window depth of the point at Z = z: 1 at the near plane, 0 at infinity. Reversed, because floats
/// are densest near 0: at Z = 1 m the resolution is 6e-8 of Z.
float window_depth(float z, float near) { return near / z; }

#include "occlusion_bias.glsl"

/// The share of a body at depth body_z that is hidden by a real surface at depth real_z: 0 if that
/// is nearer by less than the bias, 1 beyond twice the bias, smooth between, so that noise causes
/// no flicker. real_z = 0 means unknown and hides nothing.
float hidden_share(float body_z, float real_z) {
  if (!(real_z > 0.0f)) return 0.0f;
  float bias = occlusion_bias(body_z);
  return smoothstep(bias, 2.0f * bias, body_z - real_z);
}
