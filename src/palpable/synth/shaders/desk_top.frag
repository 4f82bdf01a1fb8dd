#version 450 core
// How much of the window's light reaches the desk's top, as a picture in the plane of a shadow map.
#include "lit.glsl"
uniform sampler2DShadow shadow;
uniform float spread;       // of lit(), 0..1 across the map
uniform vec3 depth_of_top;  // z in the map: dot with (u, v, 1)

out float reaches;

void main() {
  vec2 at = gl_FragCoord.xy / vec2(textureSize(shadow, 0));
  reaches = lit(shadow, vec3(at, dot(depth_of_top, vec3(at, 1.0))), spread);
}
