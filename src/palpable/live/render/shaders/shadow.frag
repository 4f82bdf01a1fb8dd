#version 450 core
// Darkens the background where bodies throw shadows (real_shadows.h). Blended by multiplication.
layout(binding = 0) uniform sampler2D left;  // share of light left, one texel per 2 x 2 pixels
uniform vec2 corner;                         // px, the first texel's corner
uniform vec2 used;                           // size of the valid part of `left`, texels

layout(location = 0) out vec4 factor;

void main() {
  vec2 at = min(0.5 * (gl_FragCoord.xy - corner), used - 0.5);
  factor = vec4(vec3(texture(left, at / vec2(textureSize(left, 0))).r), 1.0);
}
