#version 450 core
// The share of the sun's light that reaches the desk's top. Each pixel corresponds to a texel of a
// shadow map and holds the share for the point of the top that the sun sees there.
#include "lit.glsl"
uniform sampler2DShadow shadow;
uniform float spread;       // of lit(); 1 is the width of the map
uniform vec3 depth_of_top;  // depth of the top in the map: dot with (u, v, 1)

out float reaches;

void main() {
  vec2 at = gl_FragCoord.xy / vec2(textureSize(shadow, 0));
  reaches = lit(shadow, vec3(at, dot(depth_of_top, vec3(at, 1.0))), spread);
}
