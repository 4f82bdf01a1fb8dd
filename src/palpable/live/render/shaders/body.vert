#version 450 core
// Transforms a body from the body frame to the camera frame and clip space.
layout(location = 0) in vec3 position;  // body frame, m
layout(location = 1) in vec3 normal;    // body frame, unit
layout(location = 2) in float scalar;   // Pa, or m
layout(location = 3) in float mark;     // 0 plain .. 1 marked
layout(location = 4) in float shade;    // share of the lamp's light that real things block

#include "depth.glsl"
#include "project.glsl"

uniform mat4 camera_from_body;
uniform float scalar_max;  // top of the colour scale, > 0, in the unit of `scalar`

out vec3 x_in_camera;  // m
out vec3 n_in_camera;
out float share;       // of the colour scale; below 0 where it has two sides
out float marked;
out float shaded;

void main() {
  vec4 x = camera_from_body * vec4(position, 1.0);
  x_in_camera = x.xyz;
  n_in_camera = mat3(camera_from_body) * normal;
  share = scalar / scalar_max;
  marked = mark;
  shaded = shade;
  gl_Position = clip_of_camera(x.xyz);
}
