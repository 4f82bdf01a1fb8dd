#version 450 core
// The smallest sum of each pixel, and its two neighbours.
layout(local_size_x = 64) in;
#include "stereo.glsl"

void main() {
  int x = int(gl_GlobalInvocationID.x);
  int y = int(gl_WorkGroupID.y);
  if (x >= W) return;
  int begin = (y * W + x) * D;
  int best = 0;
  for (int d = 1; d < D; ++d) {
    if (sums[begin + d] < sums[begin + best]) best = d;
  }
  uint before = best > 0 ? sums[begin + best - 1] : 255u;
  uint after = best + 1 < D ? sums[begin + best + 1] : 255u;
  found[y * W + x] = uvec2(uint(best), sums[begin + best] | before << 8 | after << 16);
}
