#version 450 core
// Of the middle of the exposure.
layout(location = 0) in vec3 position;       // as the shutter opens; desk frame, m
layout(location = 4) in vec3 last_position;  // as it closes
uniform mat4 clip_from_desk;
void main() { gl_Position = clip_from_desk * vec4(mix(position, last_position, 0.5), 1.0); }
