#version 450 core
// Lines of a width in pixels: a strip of four vertices for each.
layout(location = 0) in vec3 from;        // world, m
layout(location = 1) in vec3 to;          // world, m
layout(location = 2) in vec3 tint;        // sRGB
layout(location = 3) in float half_width; // px

#include "depth.glsl"
#include "project.glsl"

uniform mat4 camera_from_world;
uniform float width_scale;  // px of this framebuffer per px of the picture
uniform float cap;          // 1: ends are round, 0: cut off at the line's ends

flat out vec3 paint;
flat out float reach;                 // px
flat out float length_px;
noperspective out vec2 along_across;  // px along the line from its start, px across from its middle

void main() {
  vec3 a = (camera_from_world * vec4(from, 1.0)).xyz;
  vec3 b = (camera_from_world * vec4(to, 1.0)).xyz;
  paint = tint;
  reach = half_width * width_scale;
  length_px = 0.0;
  along_across = vec2(0.0);
  if (max(a.z, b.z) <= near) {
    gl_Position = vec4(0.0, 0.0, -1.0, 1.0);  // outside
    return;
  }
  if (a.z < near) a = mix(b, a, (b.z - near) / (b.z - a.z));
  if (b.z < near) b = mix(a, b, (a.z - near) / (a.z - b.z));
  vec2 pa = pinhole.xy * a.xy / a.z, pb = pinhole.xy * b.xy / b.z;  // px from the principal point
  length_px = length(pb - pa);
  vec2 along = length_px > 1e-4 ? (pb - pa) / length_px : vec2(1.0, 0.0);
  float end = cap * (reach + 1.0);
  float side = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
  bool last = gl_VertexID >= 2;
  along_across = vec2(last ? length_px + end : -end, side * (reach + 1.0));
  vec2 p = pa + along_across.x * along + along_across.y * vec2(-along.y, along.x);
  float z = last ? b.z : a.z;
  gl_Position = clip_of_camera(vec3(p / pinhole.xy * z, z));
}
