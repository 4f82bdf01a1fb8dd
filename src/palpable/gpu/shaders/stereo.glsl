// What the matcher's compute shaders share; src/palpable/stereo/stereo_kernels.h has the formulas.
//
//   W, H, D   width, height, disparities
//   codes     (H x W) 24 bits each, left then right
//   sums      (H x W x D) sums of the paths so far

layout(std430, binding = 0) buffer Luma { uint luma[]; };    // (2 x H x W): left, right
layout(std430, binding = 1) buffer Codes { uint codes[]; };  // (2 x H x W)
layout(std430, binding = 2) buffer Sums { uint sums[]; };    // (H x W x D)
layout(std430, binding = 3) buffer Found { uvec2 found[]; };  // (H x W): best, cost | before | after

uniform int W;      // px
uniform int H;      // px
uniform int D;      // how many disparities
uniform int first;  // disparity d = 0 is this many px

uint raw_cost(int x, int y, int d) {
  int partner = clamp(x - first - d, 0, W - 1);
  return uint(bitCount(codes[y * W + x] ^ codes[(H + y) * W + partner]));
}

uint cost(int x, int y, int d) {
  uint sides = (raw_cost(max(x - 1, 0), y, d) + raw_cost(min(x + 1, W - 1), y, d) + 1u) / 2u;
  return (sides + raw_cost(x, y, d) + 1u) / 2u;
}
