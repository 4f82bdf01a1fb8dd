#include "palpable/render/fill_unknown.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>

using namespace palpable;

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// The nearest known depth by looking at everything.
float slow_fill(const DepthImage& depth, const PixelBox& box, int radius, int x, int y) {
  int best = radius * radius + 1;
  float value = 0;
  for (int v = box.y0; v < box.y1; ++v) {
    for (int u = box.x0; u < box.x1; ++u) {
      const float z = depth(u, v);
      if (!(z > 0.0f) || !std::isfinite(z)) continue;
      if (std::abs(u - x) > radius || std::abs(v - y) > radius) continue;
      const int distance = (u - x) * (u - x) + (v - y) * (v - y);
      if (distance < best || (distance == best && z > value)) {
        best = distance;
        value = z;
      }
    }
  }
  return value;
}

}  // namespace

TEST_CASE("a hole takes its nearest known neighbour within the radius", "[render]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<float> depth_of(0.2f, 2.0f);
    std::bernoulli_distribution known(seed % 2 == 0 ? 0.1 : 0.6);
    DepthImage depth(23, 17, kUnknown);
    for (float& z : depth) {
      if (known(random)) z = depth_of(random);
    }
    const PixelBox box{3, 2, 21, 17};
    std::vector<signed char> nearest;
    std::vector<float> filled;
    fill_unknown(depth, box, 3, nearest, filled);
    REQUIRE(filled.size() == 18u * 15u);
    for (int y = box.y0; y < box.y1; ++y) {
      for (int x = box.x0; x < box.x1; ++x) {
        INFO("pixel " << x << " " << y);
        CHECK(filled[static_cast<std::size_t>((y - box.y0) * box.width() + x - box.x0)] ==
              slow_fill(depth, box, 3, x, y));
      }
    }
  }
}

TEST_CASE("what is not a depth counts as unknown", "[render]") {
  DepthImage depth(5, 1, 1.0f);
  depth(0, 0) = std::numeric_limits<float>::infinity();
  depth(2, 0) = -1.0f;
  depth(4, 0) = 0.0f;
  std::vector<signed char> nearest;
  std::vector<float> filled;
  fill_unknown(depth, {0, 0, 5, 1}, 0, nearest, filled);
  CHECK(filled == std::vector<float>{0, 1, 0, 1, 0});
}

TEST_CASE("filling again allocates nothing", "[render]") {
  const DepthImage depth(40, 30, kUnknown);
  std::vector<signed char> nearest;
  std::vector<float> filled;
  fill_unknown(depth, {0, 0, 40, 30}, 4, nearest, filled);
  CHECK(test::allocations_during([&] {
          fill_unknown(depth, {1, 1, 39, 29}, 4, nearest, filled);
        }) == 0);
}
