// The colour scale of fields with one sign, such as von Mises stress: from steel blue (0) over rose
// to yellow (top of the scale).
//
// A path through CIELAB with L* rising evenly from 36 to 93, so that more stress is always lighter,
// in print and for every kind of colour vision; fitted by a polynomial in sRGB of degree 6 to 0.05.
// Also compiled as C++ (color_map.cpp).

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

/// The colour (sRGB) of a material painted with a share t of the scale. The scale's colours cover
/// the material completely from the share `opaque` on and are blended below, so that parts without
/// load have the material's colour. opaque = 0: no blending.
vec3 painted(vec3 material, float t, float opaque) {
  float cover = opaque > 0.0f ? smoothstep(0.15f * opaque, opaque, t) : 1.0f;
  return (1.0f - cover) * material + cover * color_map(t);
}

// The colour scale of fields with two signs: from deep blue (-1) over light grey (0) to deep red
// (1). Values of the same size are about equally dark on both sides, and larger ones are always
// darker; blue and red can be distinguished with every kind of colour vision. Each side is a
// parabola in sRGB.

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

/// painted() with the two-sided colours: values near 0 on either side have the material's colour.
vec3 two_sided_painted(vec3 material, float t, float opaque) {
  float cover = opaque > 0.0f ? smoothstep(0.15f * opaque, opaque, abs(t)) : 1.0f;
  return (1.0f - cover) * material + cover * two_sided_color_map(t);
}
