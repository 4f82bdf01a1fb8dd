#include "palpable/live/depth/flying_pixels.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <limits>

namespace palpable {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kDiagonal = 1.41421356f;

// How far z lies from the nearer one of two depths between which it lies, m; 0 or less if it does
// not, or if one of them is unknown. Without branches, so that a loop over it is vectorised.
inline float between(float a, float z, float b) {
  a = a > 0 ? a : z;
  b = b > 0 ? b : z;
  return std::max(std::min(z - a, b - z), std::min(z - b, a - z));
}

}  // namespace

void leave_out_flying_pixels(const DepthImage& depth, float f_px, float farthest,
                             DepthImage& kept) {
  PALPABLE_EXPECT(f_px > 0, "a focal length is positive");
  const int width = depth.width(), height = depth.height();
  kept.resize(width, height);
  const auto in_range = [&](float z) { return z > 0 && z <= farthest ? z : kUnknown; };
  for (int y = 0; y < height; ++y) {
    const float* row = depth.row(y);
    float* to = kept.row(y);
    if (y == 0 || y + 1 == height || width < 3) {
      std::transform(row, row + width, to, in_range);
      continue;
    }
    const float *above = depth.row(y - 1), *below = depth.row(y + 1);
    to[0] = in_range(row[0]);
    to[width - 1] = in_range(row[width - 1]);
    for (int x = 1; x + 1 < width; ++x) {
      const float z = row[x];
      const float straight =
          std::max(between(row[x - 1], z, row[x + 1]), between(above[x], z, below[x]));
      const float diagonal =
          std::max(between(above[x - 1], z, below[x + 1]), between(above[x + 1], z, below[x - 1]));
      const float most = kSteepestSurface / f_px * z;
      to[x] = std::max(straight, diagonal / kDiagonal) > most ? kUnknown : z;
    }
    // A loop of its own: both are vectorised.
    std::transform(to + 1, to + width - 1, to + 1, in_range);
  }
}

}  // namespace palpable
