#version 450 core
layout(location = 0) in vec3 position;  // desk frame, m
uniform mat4 clip_from_desk;
void main() { gl_Position = clip_from_desk * vec4(position, 1.0); }
