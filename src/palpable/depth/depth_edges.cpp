#include "palpable/depth/depth_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {

void forget_jumps(DepthImage& depth, double share, MaskImage& scratch) {
  PALPABLE_EXPECT(share > 0, "a jump is a positive share of the depth");
  const int width = depth.width();
  const int height = depth.height();
  const float factor = static_cast<float>(1.0 + share);
  scratch.resize(width, height);
  std::fill(scratch.begin(), scratch.end(), std::uint8_t{0});
  // False when either is NaN: an unknown neighbour is no jump.
  const auto jump = [factor](float a, float b) { return a > factor * b || b > factor * a; };
  for (int y = 0; y < height; ++y) {
    const float* here = depth.row(y);
    const float* below = y + 1 < height ? depth.row(y + 1) : nullptr;
    std::uint8_t* mark = scratch.row(y);
    for (int x = 0; x + 1 < width; ++x) {
      if (jump(here[x], here[x + 1])) mark[x] = mark[x + 1] = 255;
    }
    if (below == nullptr) continue;
    std::uint8_t* mark_below = scratch.row(y + 1);
    for (int x = 0; x < width; ++x) {
      if (jump(here[x], below[x])) mark[x] = mark_below[x] = 255;
    }
  }
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (scratch.data()[i] != 0) depth.data()[i] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace palpable
