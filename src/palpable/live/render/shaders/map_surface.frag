#version 450 core
in vec3 paint;
layout(location = 0) out vec4 color;  // sRGB
void main() { color = vec4(paint, 1.0); }
