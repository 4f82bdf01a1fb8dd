#version 450 core
layout(location = 0) in vec3 position;  // desk frame, m
uniform mat4 clip_from_desk;
uniform vec4 depth_from_desk;  // Z in the camera: dot with (x, y, z, 1)
out float depth;
void main() {
  depth = dot(depth_from_desk, vec4(position, 1.0));
  gl_Position = clip_from_desk * vec4(position, 1.0);
}
