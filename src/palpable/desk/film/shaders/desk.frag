#version 450 core
// A surface in the light of a window (the sun, with shadows) and of the room. Light is computed
// linearly and written as its square root; images hold square roots, too.
//
// One program is compiled for each kind of surface, with only the features that it needs, because
// Mesa's software renderer executes both sides of a branch:
//
//   FAR             lit at its vertices (desk.vert), without shadows or highlights
//   STILL_SHADOWS   still things cast shadows on it
//   MOVING_SHADOWS  movers cast shadows on it
//   DESK_TOP        the desk's top, for which the share of the sun was computed before (desk_top.frag)
//   MOVES           a mover
//   DETAIL          a mover with finger nails or creases
//   DARK            a mover that faces away from the sun
uniform sampler2D image;
in vec2 image_uv;
out vec4 color;

#ifdef FAR
in vec3 light_root;
void main() { color = vec4(min(texture(image, image_uv).rgb * light_root, 1.0), 1.0); }
#else

#include "daylight.glsl"
#ifdef MOVES
in vec3 n;
#ifndef DARK
in vec3 half_way;
#endif
in float open_room;
#ifdef DETAIL
in float crease;
in vec2 nail;
#endif
#else
in vec3 at;
uniform vec3 eye;  // desk frame, m
#endif
#ifdef DESK_TOP
const vec3 n = vec3(0.0, 0.0, 1.0);
#define Shadow sampler2D
float lit(sampler2D top, vec3 p, float spread) { return texture(top, p.xy).r; }
#else
#ifndef MOVES
in vec3 n;
#endif
#define Shadow sampler2DShadow
#include "lit.glsl"
#endif
#ifdef STILL_SHADOWS
in vec3 in_static_light;  // position in the shadow map and depth from the sun, 0..1
uniform Shadow static_shadow;
#endif
#ifdef MOVING_SHADOWS
in vec3 in_hand_light;
uniform Shadow hand_shadow;
#endif
#ifndef DARK
uniform vec3 to_sun;  // desk frame, unit
uniform float gloss;
uniform float sharpness;
#endif

void main() {
  vec3 normal = normalize(n);
  vec3 encoded = texture(image, image_uv).rgb;
#ifndef DARK
  float shine = gloss;
  float exponent = sharpness;
#endif
#ifdef DETAIL
  encoded *= 1.0 - 0.10 * crease * (0.6 + 0.4 * sin(image_uv.x * 180.0));
  if (dot(nail, nail) < 1.0) {
    float rim = smoothstep(0.80, 1.0, dot(nail, nail));
    encoded = mix(vec3(0.93, 0.75, 0.69), encoded * 0.84, rim);
    shine = 0.45;
    exponent = 45.0;
  }
#endif
  vec3 albedo = encoded * encoded;
  vec3 room = room_light(normal);
#ifdef MOVES
  room *= open_room;
#endif
#ifdef DARK
  vec3 light = albedo * room;
#else
  float sun = max(dot(normal, to_sun), 0.0);
#ifdef STILL_SHADOWS
  sun *= lit(static_shadow, in_static_light, 2.25 / 2048.0);
#endif
#ifdef MOVING_SHADOWS
  sun *= lit(hand_shadow, in_hand_light, 2.25 / 1024.0);
#endif
#ifndef MOVES
  vec3 half_way = to_sun + normalize(eye - at);
#endif
  vec3 light = albedo * (room + sun * kSun);
  if (shine > 0.0 && sun > 0.0) {
    float highlight = pow(max(dot(normal, normalize(half_way)), 0.0), exponent);
    light += shine * highlight * min(1.0, 4.0 * sun) * kSun;
  }
#endif
  color = vec4(sqrt(clamp(light, 0.0, 1.0)), 1.0);
}
#endif
