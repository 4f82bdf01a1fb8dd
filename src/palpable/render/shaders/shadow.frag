#version 450 core
// Darkens the background where a body keeps the light from it: the plane that it stands on, and what
// real stands there, as far as its depth is known. Blended by multiplication.

layout(binding = 0) uniform sampler2D shade;       // 0 none .. 1 all light kept away; m: how high
layout(binding = 1) uniform sampler2D real_depth;  // m, 0 unknown
uniform vec4 pinhole;            // fx, fy, cx, cy in px
uniform mat4 body_from_camera;
uniform vec4 patch_box;          // body frame, m: x0, y0, x1, y1 of `shade` on the plane Z = 0
uniform vec2 slope;              // by which a shadow moves for each m of height (ground_shadow.h)
uniform vec2 depth_per_picture;  // texels of real_depth per pixel of the picture
uniform float strength;          // 0 .. 1: how dark a full shadow is

#include "depth.glsl"

layout(location = 0) out vec4 factor;

vec3 eye, along;  // body frame: the camera; the way of this pixel's ray for each m of Z in the camera
float plane_z;    // where the ray meets the plane; below 0: nowhere

/// Share of the light kept from the surface at depth real_z.
float shade_at(float real_z) {
  // The plane is only assumed: within 8 mm (and the noise) a surface is taken to be on it, and so is
  // what has no depth.
  bool known = real_z > 0.0;
  if (!known && plane_z <= 0.0) return 0.0;
  vec3 at = eye + along * (known ? real_z : plane_z);
  float tolerance = 0.008 + 2.0 * occlusion_bias(max(real_z, 0.0));
  if (plane_z > 0.0 && abs(at.z) < tolerance) at = eye + along * plane_z;
  vec2 uv = (at.xy - slope * at.z - patch_box.xy) / (patch_box.zw - patch_box.xy);
  if (uv != clamp(uv, 0.0, 1.0)) return 0.0;
  vec2 there = texture(shade, uv).rg;
  // What is as high as the part that throws the shadow is lit; so is what lies below the plane.
  float below = at.z <= 0.0 ? 1.0 - smoothstep(tolerance, 2.0 * tolerance, -at.z)
                            : 1.0 - smoothstep(there.g - 0.04, there.g, at.z);
  return below * there.r;
}

void main() {
  vec3 ray = vec3((gl_FragCoord.xy - 0.5 - pinhole.zw) / pinhole.xy, 1.0);
  eye = body_from_camera[3].xyz;
  along = mat3(body_from_camera) * ray;
  plane_z = -eye.z / along.z;
  // Mixed between texels, so that the depth's stairs do not show.
  vec2 t = gl_FragCoord.xy * depth_per_picture - 0.5;
  ivec2 a = ivec2(floor(t));
  ivec2 end = textureSize(real_depth, 0) - 1;
  ivec2 low = clamp(a, ivec2(0), end);
  ivec2 high = clamp(a + 1, ivec2(0), end);
  vec2 f = t - floor(t);
  float s00 = shade_at(texelFetch(real_depth, low, 0).r);
  float s10 = shade_at(texelFetch(real_depth, ivec2(high.x, low.y), 0).r);
  float s01 = shade_at(texelFetch(real_depth, ivec2(low.x, high.y), 0).r);
  float s11 = shade_at(texelFetch(real_depth, high, 0).r);
  factor = vec4(vec3(1.0 - strength * mix(mix(s00, s10, f.x), mix(s01, s11, f.x), f.y)), 1.0);
}
