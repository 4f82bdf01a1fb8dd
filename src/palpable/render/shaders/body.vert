#version 450 core
// A streamed body: body frame in, camera frame and clip space out.
layout(location = 0) in vec3 position;  // body frame, m
layout(location = 1) in vec3 normal;    // body frame, unit
layout(location = 2) in float scalar;   // Pa
layout(location = 3) in float mark;     // 0 plain .. 1 marked

#include "depth.glsl"
#include "project.glsl"

uniform mat4 camera_from_body;
uniform float scalar_max;  // Pa, > 0: top of the colour scale

out vec3 x_in_camera;  // m
out vec3 n_in_camera;
out float share;       // of the colour scale
out float marked;
out float shaded;      // share of the lamp that real things keep away

// The shadow of what the camera sees on the body. A vertex looks along the light: where it comes behind
// a real surface, but not far behind (what is seen from the front is taken to be so thick), there
// stands something. Only what the camera sees throws shadows.
layout(binding = 4) uniform sampler2D real_depth;  // m, 0 unknown
uniform vec4 real_box;           // x0 y0 x1 y1 in texels, where it is known; empty: nowhere
uniform vec2 depth_per_picture;  // texels of real_depth per pixel of the picture
uniform vec3 key;                // camera frame, unit, towards the light

const float kThickness = 0.035;  // m, of a hand
const int kSteps = 12;

float shaded_at(vec3 x, vec3 n) {
  if (real_box.z <= real_box.x || dot(n, key) <= 0.0) return 0.0;
  float most = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    float t = 0.006 * float(i) + 0.0004 * float(i * i);  // m: dense where things touch
    vec3 p = x + 0.003 * n + t * key;
    if (p.z < near) break;
    vec2 texel = (pinhole.xy * p.xy / p.z + pinhole.zw + 0.5) * depth_per_picture;
    if (any(lessThan(texel, real_box.xy)) || any(greaterThanEqual(texel, real_box.zw))) break;
    float real = texelFetch(real_depth, ivec2(texel), 0).r;
    if (!(real > 0.0)) continue;
    float behind = p.z - real;
    float bias = 0.002 + occlusion_bias(p.z);
    // Farther things throw softer shadows.
    float here = smoothstep(bias, 1.5 * bias, behind) *
                 (1.0 - smoothstep(0.8 * kThickness, kThickness, behind)) * (1.0 - 0.05 * float(i));
    most = max(most, here);
  }
  return 0.85 * most;
}

void main() {
  vec4 x = camera_from_body * vec4(position, 1.0);
  x_in_camera = x.xyz;
  n_in_camera = mat3(camera_from_body) * normal;
  share = scalar / scalar_max;
  marked = mark;
  shaded = shaded_at(x_in_camera, n_in_camera);
  gl_Position = clip_of_camera(x.xyz);
}
