#version 450 core
// Census codes of both images; z says which.
layout(local_size_x = 64) in;
#include "stereo.glsl"
uniform int STEP;  // grey levels by which a neighbour must be darker to count

int grey(int eye, int x, int y) {
  return int(luma[(eye * H + clamp(y, 0, H - 1)) * W + clamp(x, 0, W - 1)]);
}

void main() {
  int x = int(gl_GlobalInvocationID.x);
  int y = int(gl_WorkGroupID.y);
  int eye = int(gl_WorkGroupID.z);
  if (x >= W) return;
  int centre = grey(eye, x, y);
  uint code = 0u;
  int bit = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      if (dx == 0 && dy == 0) continue;
      if (grey(eye, x + dx, y + dy) + STEP < centre) code |= 1u << bit;
      ++bit;
    }
  }
  codes[(eye * H + y) * W + x] = code;
}
