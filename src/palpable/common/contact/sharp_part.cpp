#include "palpable/common/contact/sharp_part.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3f;

// Largest error of a depth: m, and ratio to the depth.
constexpr float kDepthError = 1.5e-4f, kDepthShare = 0.1f;
// Largest number of queries along an axis. An axis that lies along the skin needs many: those after
// kFineLooks are spread over its rest.
constexpr int kMostLooks = 200, kFineLooks = 150;

// The part of a line that is inside a box, as values of its parameter between 0 and 1; first > last
// if there is none.
struct Within {
  float first = 0, last = 1;
};
Within clip(const Vector3f& from, const Vector3f& way, const Eigen::AlignedBox3f& box) {
  Within within;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(way[k]) < std::numeric_limits<float>::min()) {
      if (from[k] < box.min()[k] || from[k] > box.max()[k]) return {1, 0};
      continue;
    }
    const float low = (box.min()[k] - from[k]) / way[k], high = (box.max()[k] - from[k]) / way[k];
    within.first = std::max(within.first, std::min(low, high));
    within.last = std::min(within.last, std::max(low, high));
  }
  return within;
}

// r(t) - phi(x(t)), m; minus infinity where no triangle is found.
float depth_at(const SharpPart& part, const Vector3f& way, float t, const MovingSurface& skin) {
  const auto found = skin.nearest(part.a + t * way, std::numeric_limits<float>::max());
  if (!found) return -std::numeric_limits<float>::infinity();
  return part.radius_a + t * (part.radius_b - part.radius_a) - found->distance;
}

}  // namespace

double depth_of(const SharpPart& part, const MovingSurface& skin) {
  const Vector3f way = part.b - part.a;
  const float length = way.norm(), radius = std::max(part.radius_a, part.radius_b);
  Eigen::AlignedBox3f box = skin.bounds();
  box.min().array() -= radius;
  box.max().array() += radius;
  const Within within = clip(part.a, way, box);
  if (!(within.first <= within.last)) return 0;
  // The depth changes by no more than this, m, over a whole axis.
  const float change = length + std::abs(part.radius_b - part.radius_a);
  float here = depth_at(part, way, within.first, skin);
  float deepest = std::max(here, depth_at(part, way, within.last, skin));
  float t = within.first;
  for (int look = 0; look < kMostLooks && change > 0; ++look) {
    // Half way between two looks the depth is larger than at both by half their distance at most.
    float way_on = 2 * std::max(kDepthError, kDepthShare * deepest);
    if (look >= kFineLooks) {
      way_on = std::max(way_on, (within.last - t) * change / static_cast<float>(kMostLooks - look));
    }
    t += std::max(std::max(deepest, 0.0f) - here, way_on) / change;
    if (!(t < within.last)) break;
    here = depth_at(part, way, t, skin);
    deepest = std::max(deepest, here);
  }
  return std::max(0.0, static_cast<double>(deepest));
}

double depth_of_enclosed(const SharpPart& part, const MovingSurface& skin) {
  const Vector3f way = part.b - part.a;
  const Eigen::AlignedBox3f box = skin.bounds();
  float deepest = 0;
  for (const float t : {0.0f, 0.5f, 1.0f}) {
    if (!box.contains(part.a + t * way)) continue;
    const float depth = depth_at(part, way, t, skin);
    const float radius = part.radius_a + t * (part.radius_b - part.radius_a);
    if (depth - radius > static_cast<float>(kReached)) deepest = std::max(deepest, depth);
    if (way.isZero()) break;  // a ball has one place
  }
  return static_cast<double>(deepest);
}

}  // namespace palpable
