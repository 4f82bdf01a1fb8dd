#version 450 core
// Dots on a body: small balls, drawn as points.
layout(location = 0) in vec3 position;  // body frame, m
layout(location = 1) in float radius;   // m
layout(location = 2) in vec3 tint;      // sRGB

#include "depth.glsl"
#include "project.glsl"

uniform mat4 camera_from_body;

flat out vec3 centre;  // camera frame, m
flat out float r;      // m
flat out vec3 albedo;

void main() {
  vec4 x = camera_from_body * vec4(position, 1.0);
  centre = x.xyz;
  r = radius;
  albedo = tint;
  gl_Position = clip_of_camera(x.xyz);
  gl_PointSize = max(2.0 * pinhole.x * radius / max(x.z, near), 1.0);
}
