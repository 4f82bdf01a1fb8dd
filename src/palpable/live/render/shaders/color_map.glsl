// The colour scales of fields with one sign, such as von Mises stress, by number (ColorScale in
// color_map.h). Also compiled as C++ (color_map.cpp).

// 0: from steel blue (0) over rose to yellow (top of the scale). A path through CIELAB with L*
// rising evenly from 36 to 93, so that more stress is always lighter, in print and for every kind of
// colour vision; fitted by a polynomial in sRGB of degree 6 to 0.05.
vec3 blue_yellow(float t) {
  const vec3 c0 = vec3(0.046f, 0.337f, 0.571f);
  const vec3 c1 = vec3(3.692f, 0.426f, 1.203f);
  const vec3 c2 = vec3(-13.165f, -1.426f, -2.513f);
  const vec3 c3 = vec3(52.744f, -3.508f, -2.945f);
  const vec3 c4 = vec3(-109.945f, 21.823f, 8.329f);
  const vec3 c5 = vec3(102.577f, -27.4f, -5.853f);
  const vec3 c6 = vec3(-34.971f, 10.679f, 1.624f);
  return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
}

// 1: viridis of Smith and van der Walt (matplotlib, CC0), fitted by a polynomial of degree 6
// to 0.017.
vec3 viridis(float t) {
  const vec3 c0 = vec3(0.274f, 0.006f, 0.333f);
  const vec3 c1 = vec3(0.108f, 1.396f, 1.387f);
  const vec3 c2 = vec3(-0.327f, 0.215f, 0.092f);
  const vec3 c3 = vec3(-4.6f, -5.758f, -19.292f);
  const vec3 c4 = vec3(6.204f, 14.154f, 56.656f);
  const vec3 c5 = vec3(4.752f, -13.749f, -65.321f);
  const vec3 c6 = vec3(-5.432f, 4.642f, 26.272f);
  return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
}

// 2: blue, cyan, green, yellow, red, each edge a straight line in sRGB.
vec3 rainbow(float t) {
  return vec3(1.5f - abs(4.0f * t - 3.0f), 1.5f - abs(4.0f * t - 2.0f),
              1.5f - abs(4.0f * t - 1.0f));
}

// 3: from dark grey to white.
vec3 gray(float t) {
  float g = 0.2f + 0.8f * t;
  return vec3(g, g, g);
}

/// sRGB, 0..1, of a share t of the scale; t is clamped to 0..1.
vec3 color_map(float t, int scale) {
  t = clamp(t, 0.0f, 1.0f);
  vec3 color = blue_yellow(t);
  if (scale == 1) color = viridis(t);
  if (scale == 2) color = rainbow(t);
  if (scale == 3) color = gray(t);
  return clamp(color, 0.0f, 1.0f);
}

/// The colour (sRGB) of a material painted with a share t of the scale. The scale's colours cover
/// the material completely from the share `opaque` on and are blended below, so that parts without
/// load have the material's colour. opaque = 0: no blending.
vec3 painted(vec3 material, float t, float opaque, int scale) {
  float cover = opaque > 0.0f ? smoothstep(0.15f * opaque, opaque, t) : 1.0f;
  return (1.0f - cover) * material + cover * color_map(t, scale);
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
