#version 450 core
// The true depth: Z in the camera frame, m, and whether the surface moves.
in float depth;
uniform float moves;  // 1: hand, sleeve, pencil or cup
out vec2 truth;
void main() { truth = vec2(depth, moves); }
