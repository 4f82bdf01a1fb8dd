#version 450 core
// The surface of the room.
layout(location = 0) in vec3 position;  // world, m
layout(location = 1) in vec3 normal;    // world, unit
layout(location = 2) in vec3 tint;      // sRGB as the camera saw it

#include "depth.glsl"
#include "project.glsl"

uniform mat4 camera_from_world;
uniform vec3 up;  // world, unit

out vec3 paint;

void main() {
  vec3 x = (camera_from_world * vec4(position, 1.0)).xyz;
  gl_Position = clip_of_camera(x);
  // The camera's colours include the light of the room. Surfaces that turn away from the eye are
  // made slightly darker, and those that face up slightly lighter, so that a table can be
  // distinguished from the floor below it.
  vec3 to_eye = normalize(-x);
  vec3 n = mat3(camera_from_world) * normal;
  float facing = max(dot(n, to_eye), 0.0);
  float shade = 0.72 + 0.22 * facing + 0.10 * dot(normal, up);
  paint = clamp(tint * shade, 0.0, 1.0);
}
