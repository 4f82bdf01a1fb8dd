#version 450 core
// Puts the bodies over the camera image, hidden where a real surface is nearer. Compares Z with Z,
// both metric. Blended as premultiplied colour.
#include "depth.glsl"

layout(binding = 0) uniform sampler2D body_color;  // sRGB; premultiplied if TRANSLUCENT
layout(binding = 1) uniform sampler2D body_depth;  // m, 0 without a body
layout(binding = 2) uniform sampler2D real_depth;  // m, 0 unknown; often coarser than the picture
layout(binding = 3) uniform sampler2D fine_depth;  // m, 0 unknown, one texel per pixel
uniform vec4 fine_box;  // x0 y0 x1 y1 of the picture, px: here fine_depth is used, not real_depth
uniform vec2 depth_per_picture;  // texels of real_depth per pixel of the picture
uniform ivec2 last;              // the last pixel of the picture

#ifdef TRANSLUCENT
#define PAINT vec4
#define PAINT_OF(texel) (texel)
#else
#define PAINT vec3
#define PAINT_OF(texel) (texel).rgb
#endif

layout(location = 0) out vec4 color;
layout(location = 1) out float visible_mask;

#ifdef HARD
/// The test of the paper: 1 where the real depth at this pixel is known and nearer, else 0.
float hidden(ivec2 p, float z) {
  float real = texelFetch(real_depth, ivec2((vec2(p) + 0.5) * depth_per_picture), 0).r;
  return real > 0.0 && real < z ? 1.0 : 0.0;
}
#else
#ifndef ALL_FINE
/// The hidden share at picture position p (pixel centres at halves). The decisions of four texels
/// are interpolated, not their depths: there is no surface half way between a hand and the wall
/// behind it.
float hidden_at(vec2 p, float z) {
  vec2 t = p * depth_per_picture - 0.5;
  vec2 corner = floor(t);
  vec2 f = t - corner;
  ivec2 a = ivec2(corner);
  ivec2 end = textureSize(real_depth, 0) - 1;
  ivec2 low = clamp(a, ivec2(0), end);
  ivec2 high = clamp(a + 1, ivec2(0), end);
  float h00 = hidden_share(z, texelFetch(real_depth, low, 0).r);
  float h10 = hidden_share(z, texelFetch(real_depth, ivec2(high.x, low.y), 0).r);
  float h01 = hidden_share(z, texelFetch(real_depth, ivec2(low.x, high.y), 0).r);
  float h11 = hidden_share(z, texelFetch(real_depth, high, 0).r);
  return mix(mix(h00, h10, f.x), mix(h01, h11, f.x), f.y);
}

#endif
/// The same with the fine depth, whose decisions are averaged over 3 x 3 pixels to soften stairs.
float hidden_at_pixel(ivec2 p, float z) {
  ivec2 low = ivec2(fine_box.xy);
  ivec2 high = ivec2(fine_box.zw) - 1;
  float sum = 0.0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      float real = texelFetch(fine_depth, clamp(p + ivec2(dx, dy), low, high), 0).r;
      sum += float((2 - abs(dx)) * (2 - abs(dy))) / 16.0 * hidden_share(z, real);
    }
  }
  return sum;
}

#ifdef ALL_FINE
/// The fine depth covers all pixels that may show a body.
float hidden(ivec2 p, float z) { return hidden_at_pixel(p, z); }
#else
float hidden(ivec2 p, float z) {
  vec2 at = vec2(p) + 0.5;
  bool is_fine = all(greaterThanEqual(at, fine_box.xy)) && all(lessThan(at, fine_box.zw));
  return is_fine ? hidden_at_pixel(p, z) : hidden_at(at, z);
}
#endif
#endif

// A software renderer executes both branches of every condition for all pixels, so each texel is
// fetched only once.
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  float own = texelFetch(body_depth, p, 0).r;
  // 3 x 3 neighbours, binomial weights: their share of body is the coverage of this pixel.
  float cover = 0.0;
  float z_sum = 0.0;
  float jump = 0.0;
  PAINT paint_sum = PAINT(0.0);
  PAINT paint = PAINT(0.0);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      ivec2 q = clamp(p + ivec2(dx, dy), ivec2(0), last);
      float z = texelFetch(body_depth, q, 0).r;
      PAINT paint_here = PAINT_OF(texelFetch(body_color, q, 0));
      float weight = float((2 - abs(dx)) * (2 - abs(dy))) / 16.0;
      if (dx == 0 && dy == 0) paint = paint_here;
      if (z > 0.0) {
        cover += weight;
        z_sum += weight * z;
        jump = max(jump, abs(z - own));
        paint_sum += weight * paint_here;
      }
    }
  }
  if (cover == 0.0) discard;
  float z = own > 0.0 ? own : z_sum / cover;
  // Averaged at the body's outline, and at outlines inside it (an ear before the back), to soften
  // stairs.
  if (own == 0.0 || jump > 0.01 * own) paint = paint_sum / cover;
  float visible = 1.0 - hidden(p, z);
  float alpha = smoothstep(0.1, 0.9, cover) * visible;
#ifdef TRANSLUCENT
  color = paint * alpha;
#else
  color = vec4(paint * alpha, alpha);
#endif
  visible_mask = own > 0.0 && visible >= 0.5 ? 1.0 : 0.0;
}
