#version 450 core
// One work group walks one path; its invocations share the disparities. DIRECTION 0: a row from left
// to right, 1: from right to left, 2: a column of a strip from above, which begins WARM_UP rows
// earlier. Sums are added to: the three directions are run one after the other.
layout(local_size_x = 64) in;
#include "stereo.glsl"
#define MOST 512
uniform int DIRECTION;  // 0, 1 or 2, as above
uniform int STRIPS;     // that the picture's height is cut into for direction 2
uniform int WARM_UP;    // rows
uniform int P1;         // bits of the census code: the disparity changes by 1 from pixel to pixel
uniform int P2;         // the same: by more, between pixels of one grey level
uniform int P2_LEAST;   // the same: by more, across an edge of the picture

shared uint path[MOST + 2];  // L of disparity d at d + 1
shared uint least_of[64];

const uint kNone = 0xffffu;

uint least() {
  uint mine = kNone;
  for (int d = int(gl_LocalInvocationID.x); d < D; d += 64) mine = min(mine, path[d + 1]);
  least_of[gl_LocalInvocationID.x] = mine;
  barrier();
  for (uint n = 32u; n > 0u; n /= 2u) {
    if (gl_LocalInvocationID.x < n) {
      least_of[gl_LocalInvocationID.x] =
          min(least_of[gl_LocalInvocationID.x], least_of[gl_LocalInvocationID.x + n]);
    }
    barrier();
  }
  return least_of[0];
}

void main() {
  int me = int(gl_LocalInvocationID.x);
  int line = int(gl_WorkGroupID.x);
  int steps = W;
  int skipped = 0;  // steps of the warm-up, whose sums are not wanted
  int x = DIRECTION == 0 ? 0 : W - 1;
  int y = line;
  if (DIRECTION == 2) {
    int strip = line / W;
    x = line % W;
    int begin = strip * H / STRIPS;
    y = max(begin - WARM_UP, 0);
    skipped = begin - y;
    steps = (strip + 1) * H / STRIPS - y;
  }
  int grey_before = 0;
  for (int i = 0; i < steps; ++i) {
    int grey = int(luma[y * W + x]);
    uint jump = uint(max(P2 - abs(grey - grey_before), P2_LEAST));
    grey_before = grey;
    uint lowest = i == 0 ? 0u : least();
    uint next[MOST / 64];
    int k = 0;
    for (int d = me; d < D; d += 64) {
      uint c = cost(x, y, d);
      if (i > 0) {
        uint best = min(path[d + 1], lowest + jump);
        if (d > 0) best = min(best, path[d] + uint(P1));
        if (d + 1 < D) best = min(best, path[d + 2] + uint(P1));
        c += best - lowest;
      }
      next[k++] = c;
    }
    barrier();  // all have read the path before anybody changes it
    k = 0;
    for (int d = me; d < D; d += 64) {
      path[d + 1] = next[k];
      if (i >= skipped) sums[(y * W + x) * D + d] += next[k];
      ++k;
    }
    barrier();
    if (DIRECTION == 0) ++x;
    if (DIRECTION == 1) --x;
    if (DIRECTION == 2) ++y;
  }
}
