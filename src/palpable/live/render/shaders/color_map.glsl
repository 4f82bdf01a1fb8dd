// The colours of what has one sign, as von Mises stress: steel blue (nothing) over rose to yellow (all of the
// scale).
//
// A path through CIELAB with L* rising evenly from 36 to 93, so that more stress is always lighter,
// in print and for every kind of colour vision; fitted by a polynomial in sRGB of degree 6 to 0.05.
// Also compiled as C++ (color_map.cpp): GLSL and C++ share this text.

/// sRGB, 0..1, of a share t of the scale; t is clamped to 0..1.
vec3 color_map(float t) {
  t = clamp(t, 0.0f, 1.0f);
  const vec3 c0 = vec3(0.046f, 0.337f, 0.571f);
  const vec3 c1 = vec3(3.692f, 0.426f, 1.203f);
  const vec3 c2 = vec3(-13.165f, -1.426f, -2.513f);
  const vec3 c3 = vec3(52.744f, -3.508f, -2.945f);
  const vec3 c4 = vec3(-109.945f, 21.823f, 8.329f);
  const vec3 c5 = vec3(102.577f, -27.4f, -5.853f);
  const vec3 c6 = vec3(-34.971f, 10.679f, 1.624f);
  return clamp(c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6))))), 0.0f, 1.0f);
}

/// A material of this colour (sRGB) with a share t of the scale painted on it. Paint covers it wholly
/// from the share `opaque` on and lets it through below, so that what bears nothing looks like the
/// material; 0: it covers everywhere.
vec3 painted(vec3 material, float t, float opaque) {
  float cover = opaque > 0.0f ? smoothstep(0.15f * opaque, opaque, t) : 1.0f;
  return (1.0f - cover) * material + cover * color_map(t);
}

// The colours of what has two signs: deep blue (the scale's length below 0) over a light grey (0) to deep
// red. As far from 0 on either side is about as dark, and farther is always darker; blue and red are told
// apart by every kind of colour vision. Each side is a parabola in sRGB through its end and a middle.

/// sRGB, 0..1, of a share t of the scale; t is clamped to -1..1.
vec3 two_sided_color_map(float t) {
  t = clamp(t, -1.0f, 1.0f);
  const vec3 zero = vec3(0.95f, 0.95f, 0.95f);
  const vec3 blue1 = vec3(-1.27f, -0.45f, -0.03f);
  const vec3 blue2 = vec3(0.42f, -0.18f, -0.3f);
  const vec3 red1 = vec3(0.25f, -0.62f, -1.3f);
  const vec3 red2 = vec3(-0.5f, -0.24f, 0.48f);
  float below = max(-t, 0.0f), above = max(t, 0.0f);
  return zero + below * (blue1 + below * blue2) + above * (red1 + above * red2);
}

/// painted() with the two-sided colours: what is near 0 on either side looks like the material.
vec3 two_sided_painted(vec3 material, float t, float opaque) {
  float cover = opaque > 0.0f ? smoothstep(0.15f * opaque, opaque, abs(t)) : 1.0f;
  return (1.0f - cover) * material + cover * two_sided_color_map(t);
}
