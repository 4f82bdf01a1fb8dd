#version 450 core
// Z in the camera, m: the truth of depth.
in float depth;
out float z;
void main() { z = depth; }
