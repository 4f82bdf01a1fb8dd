#version 450 core
// Z in the camera, m, and whether it moves: the truth of depth.
in float depth;
uniform float moves;  // 1: hand, sleeve, pencil or cup
out vec2 truth;
void main() { truth = vec2(depth, moves); }
