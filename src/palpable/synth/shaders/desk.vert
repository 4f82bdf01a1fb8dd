#version 450 core
// A painted surface, seen by an eye without a lens.
layout(location = 0) in vec3 position;  // desk frame, m
layout(location = 1) in vec3 normal;    // desk frame, unit
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 extra;  // PaintedVertex::extra
// Where it is when the shutter closes.
layout(location = 4) in vec3 last_position;
layout(location = 5) in vec3 last_normal;

uniform mat4 clip_from_desk;
uniform mat4 static_light_from_desk;  // 0..1 across the shadow map, z too
uniform mat4 hand_light_from_desk;
uniform float along;  // 0: as the shutter opens .. 1: as it closes

out vec3 at;
out vec3 n;
out vec2 image_uv;
out vec4 more;
out vec3 in_static_light;
out vec3 in_hand_light;

void main() {
  at = mix(position, last_position, along);
  n = mix(normal, last_normal, along);
  image_uv = uv;
  more = extra;
  in_static_light = (static_light_from_desk * vec4(at, 1.0)).xyz;
  // Its own shadow is that of the middle of the exposure (shadow.vert).
  in_hand_light = (hand_light_from_desk * vec4(mix(position, last_position, 0.5), 1.0)).xyz;
  gl_Position = clip_from_desk * vec4(at, 1.0);
}
