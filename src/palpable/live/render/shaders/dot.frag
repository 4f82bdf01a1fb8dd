#version 450 core
flat in vec3 centre;
flat in float r;
flat in vec3 albedo;

#include "depth.glsl"
#include "light.glsl"
#include "project.glsl"

uniform vec3 key;          // camera frame, unit, towards the light
uniform vec3 up;           // camera frame, unit
uniform vec3 light_color;  // linear, 1 = a well lit room
uniform float lamp;        // strength, 1: a window beside a desk

layout(location = 0) out vec4 color;
layout(location = 1) out float z;

void main() {
  // The pixel's ray at the depth of the centre. Perspective within the ball is neglected.
  vec2 at = (gl_FragCoord.xy - 0.5 - pinhole.zw) / pinhole.xy * centre.z - centre.xy;
  float inside = r * r - dot(at, at);
  if (inside < 0.0) discard;
  vec3 n = vec3(at, -sqrt(inside)) / r;
  z = centre.z + n.z * r;
  gl_FragDepth = window_depth(z, near);
  color = vec4(lit(albedo, n, key, up, normalize(-centre), lamp, light_color), 1.0);
}
