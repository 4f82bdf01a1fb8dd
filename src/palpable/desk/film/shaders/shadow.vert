#version 450 core
// Depth from the sun, at one moment of an exposure.
layout(location = 0) in vec3 position;       // as the shutter opens; desk frame, m
layout(location = 4) in vec3 last_position;  // as it closes
uniform mat4 clip_from_desk;
uniform float along;  // moment, 0: the shutter opens .. 1: it closes
void main() { gl_Position = clip_from_desk * vec4(mix(position, last_position, along), 1.0); }
