#include "palpable/live/depth/depth_gaps.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

struct GapStep {
  int x, y;
};
constexpr std::array kGapLines{GapStep{1, 0}, GapStep{0, 1}, GapStep{1, 1}, GapStep{1, -1}};

// A depth on a line through the unknown pixel.
struct GapSide {
  float Z = 0;         // m; 0: none is near
  float distance = 0;  // in steps along the line
};

// @param at     the unknown pixel
// @param step   to the next pixel of the line
// @param count  pixels of the line within the image and kBridgeReach
GapSide nearest_known(const float* at, std::ptrdiff_t step, int count) {
  for (int k = 1; k <= count; ++k) {
    const float Z = at[k * step];
    if (Z > 0) return {Z, static_cast<float>(k)};  // false for NaN
  }
  return {};
}

// Pixels from (x, y) to the border in this direction, kBridgeReach at most.
int reach(const DepthImage& depth, int x, int y, GapStep step) {
  int count = kBridgeReach;
  if (step.x > 0) count = std::min(count, depth.width() - 1 - x);
  if (step.x < 0) count = std::min(count, x);
  if (step.y > 0) count = std::min(count, depth.height() - 1 - y);
  if (step.y < 0) count = std::min(count, y);
  return count;
}

float bridged_depth(const DepthImage& depth, int x, int y) {
  constexpr float kUnknownDepth = std::numeric_limits<float>::quiet_NaN();
  const float* at = depth.row(y) + x;
  const std::ptrdiff_t width = depth.width();
  const bool inside = x >= kBridgeReach && y >= kBridgeReach && x < depth.width() - kBridgeReach &&
                      y < depth.height() - kBridgeReach;
  float sum = 0, least = std::numeric_limits<float>::max(), most = 0;
  int lines = 0;
  for (const GapStep& step : kGapLines) {
    const std::ptrdiff_t next = step.x + width * step.y;
    const GapSide a = nearest_known(at, next, inside ? kBridgeReach : reach(depth, x, y, step));
    if (a.Z == 0) continue;
    const GapSide b =
        nearest_known(at, -next, inside ? kBridgeReach : reach(depth, x, y, {-step.x, -step.y}));
    if (b.Z == 0) continue;
    least = std::min(least, std::min(a.Z, b.Z));
    most = std::max(most, std::max(a.Z, b.Z));
    // 1/Z, 1/m: (b.distance / a.Z + a.distance / b.Z) / (a.distance + b.distance)
    sum += (b.distance * b.Z + a.distance * a.Z) / (a.Z * b.Z * (a.distance + b.distance));
    ++lines;
  }
  if (lines == 0 || most > kSurfaceJump * least) return kUnknownDepth;
  return static_cast<float>(lines) / sum;
}

}  // namespace

void bridge_gaps(const DepthImage& depth, DepthImage& bridged) {
  bridged.resize(depth.width(), depth.height());
  for (int y = 0; y < depth.height(); ++y) {
    const float* known = depth.row(y);
    float* row = bridged.row(y);
    for (int x = 0; x < depth.width(); ++x) {
      row[x] = known[x] > 0 ? known[x] : bridged_depth(depth, x, y);
    }
  }
}

}  // namespace palpable
