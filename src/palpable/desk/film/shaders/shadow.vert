#version 450 core
// Depth from the sun at one instant of an exposure.
layout(location = 0) in vec3 position;       // at the beginning of the exposure; desk frame, m
layout(location = 4) in vec3 last_position;  // at its end
uniform mat4 clip_from_desk;
uniform float along;  // instant, 0: the shutter opens .. 1: it closes
void main() { gl_Position = clip_from_desk * vec4(mix(position, last_position, along), 1.0); }
