#version 450 core
// A painted surface, seen by an eye without a lens.
layout(location = 0) in vec3 position;  // desk frame, m
layout(location = 1) in vec3 normal;    // desk frame, unit
layout(location = 2) in vec2 uv;

uniform mat4 clip_from_desk;

invariant gl_Position;  // equal depth in all programs: one paints over a copy of another
out vec2 image_uv;

#ifdef FAR
// Far surfaces are flat: computing their light at the vertices is enough.
#include "daylight.glsl"
uniform vec3 to_sun;  // desk frame, unit
out vec3 light_root;
#else
#ifndef DESK_TOP
out vec3 n;
#endif
#ifndef MOVES
out vec3 at;
#endif
#endif

#ifdef MOVES
layout(location = 3) in vec4 extra;  // PaintedVertex::extra
// At the end of the exposure; position and normal are those at its beginning.
layout(location = 4) in vec3 last_position;
layout(location = 5) in vec3 last_normal;
uniform float along;         // instant, 0: the shutter opens .. 1: it closes
uniform float shadow_along;  // instant of the movers' shadow map (shadow.vert)
#ifndef DARK
uniform vec3 eye;     // desk frame, m
uniform vec3 to_sun;  // desk frame, unit
// The direction half way between sun and eye. It may be interpolated between the corners of a triangle
// because triangles are small compared with their distance.
out vec3 half_way;
#endif
out float open_room;  // share of the room's light that reaches the surface
#ifdef DETAIL
out float crease;
out vec2 nail;  // position on a finger nail, whose edge is the unit circle
#endif
#endif
#ifdef STILL_SHADOWS
uniform mat4 static_light_from_desk;  // to 0..1 across the shadow map, and in depth
out vec3 in_static_light;
#endif
#ifdef MOVING_SHADOWS
uniform mat4 hand_light_from_desk;
out vec3 in_hand_light;
#endif

void main() {
  vec3 where = position;
  vec3 facing = normal;
  vec3 in_shadow_map = position;
#ifdef MOVES
  where = mix(position, last_position, along);
  facing = mix(normal, last_normal, along);
  in_shadow_map = mix(position, last_position, shadow_along);
#ifndef DARK
  half_way = to_sun + normalize(eye - where);
#endif
  open_room = extra.x;
#ifdef DETAIL
  crease = extra.y;
  nail = extra.zw;
#endif
#endif
#ifdef FAR
  light_root = sqrt(room_light(facing) + max(dot(facing, to_sun), 0.0) * kSun);
#else
#ifndef DESK_TOP
  n = facing;
#endif
#ifndef MOVES
  at = where;
#endif
#endif
#ifdef STILL_SHADOWS
  in_static_light = (static_light_from_desk * vec4(where, 1.0)).xyz;
#endif
#ifdef MOVING_SHADOWS
  in_hand_light = (hand_light_from_desk * vec4(in_shadow_map, 1.0)).xyz;
#endif
  image_uv = uv;
  gl_Position = clip_from_desk * vec4(where, 1.0);
}
