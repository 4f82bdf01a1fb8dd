#version 450 core
// A patch of the plane that the body stands on (body frame Z = 0): four corners as a strip.
#include "depth.glsl"
#include "project.glsl"

uniform mat4 camera_from_body;
uniform vec4 patch_box;  // body frame, m: x0, y0, x1, y1

out vec2 uv;
out vec3 x_in_camera;

void main() {
  uv = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
  x_in_camera = (camera_from_body * vec4(mix(patch_box.xy, patch_box.zw, uv), 0.0, 1.0)).xyz;
  gl_Position = clip_of_camera(x_in_camera);
}
