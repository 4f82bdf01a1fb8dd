#version 450 core
// Darkens the background where the body keeps light from the plane that it stands on, but not what
// stands before or behind that plane. Blended by multiplication.
in vec2 uv;
in vec3 x_in_camera;

#include "depth.glsl"

layout(binding = 0) uniform sampler2D shade;       // 0 none .. 1 all light kept away
layout(binding = 1) uniform sampler2D real_depth;  // m, 0 unknown
uniform vec2 depth_per_picture;  // texels of real_depth per pixel of the picture
uniform float strength;          // 0 .. 1: how dark a full shadow is

layout(location = 0) out vec4 factor;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy * depth_per_picture);
  float real_z = texelFetch(real_depth, texel, 0).r;
  // The plane is only assumed: within 15 mm (and the noise) a surface is taken to be on it.
  float tolerance = 0.015 + 2.0 * occlusion_bias(x_in_camera.z);
  float off_plane = real_z > 0.0 ? abs(real_z - x_in_camera.z) / tolerance : 0.0;
  float on_plane = 1.0 - smoothstep(1.0, 2.0, off_plane);
  factor = vec4(vec3(1.0 - strength * on_plane * texture(shade, uv).r), 1.0);
}
