#include "palpable/live/render/fill_unknown.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>

using namespace palpable;

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

bool is_known(float z) { return z > 0.0f && std::isfinite(z); }

/// The second rule of fill_unknown()'s comment, by a search of all pixels.
float slow_fill(const DepthImage& depth, const PixelBox& box, int radius, int x, int y) {
  if (is_known(depth(x, y))) return depth(x, y);
  int left = x, right = x;
  while (left >= box.x && !is_known(depth(left, y))) --left;
  while (right < box.right() && !is_known(depth(right, y))) ++right;
  if (left >= box.x && right < box.right() && right - left - 1 <= kLongestHalfSeen &&
      depth(left, y) > 1.1f * depth(right, y)) {
    return depth(left, y);
  }
  int best = radius * radius + 1;
  float value = 0;
  for (int v = box.y; v < box.bottom(); ++v) {
    for (int u = box.x; u < box.right(); ++u) {
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
    const PixelBox box = PixelBox::between(3, 2, 21, 17);
    std::vector<signed char> nearest;
    std::vector<float> filled;
    fill_unknown(depth, nullptr, box, 3, nearest, filled);
    REQUIRE(filled.size() == 18u * 15u);
    for (int y = box.y; y < box.bottom(); ++y) {
      for (int x = box.x; x < box.right(); ++x) {
        INFO("pixel " << x << " " << y);
        CHECK(filled[(y - box.y) * box.width + x - box.x] == slow_fill(depth, box, 3, x, y));
      }
    }
  }
}

TEST_CASE("left of a near thing a hole is background, right of it and within it is not",
          "[render]") {
  DepthImage depth(12, 1, 0.5f);
  depth(5, 0) = depth(6, 0) = depth(9, 0) = 0.3f;  // a finger from 5 to 9 with a hole in it
  depth(2, 0) = depth(3, 0) = depth(4, 0) = kUnknown;
  depth(7, 0) = depth(8, 0) = kUnknown;
  depth(10, 0) = kUnknown;
  std::vector<signed char> nearest;
  std::vector<float> filled;
  fill_unknown(depth, nullptr, {0, 0, 12, 1}, 3, nearest, filled);
  CHECK(filled[4] == 0.5f);  // beside the finger, but to its left
  CHECK(filled[2] == 0.5f);
  CHECK(filled[7] == 0.3f);
  CHECK(filled[8] == 0.3f);
  CHECK(filled[10] == 0.5f);       // of two equally near the farther
  CHECK(nearest[4] == kHalfSeen);  // marked, unlike other holes
  CHECK(nearest[7] != 0);
}

TEST_CASE("a hole that is too long for one eye alone is not called background", "[render]") {
  DepthImage depth(kLongestHalfSeen + 3, 1, kUnknown);
  depth(0, 0) = 0.5f;
  depth(kLongestHalfSeen + 2, 0) = 0.3f;
  std::vector<signed char> nearest;
  std::vector<float> filled;
  fill_unknown(depth, nullptr, {0, 0, depth.width(), 1}, 3, nearest, filled);
  CHECK(filled[kLongestHalfSeen + 1] == 0.3f);
  CHECK(filled[kLongestHalfSeen / 2] == 0.0f);
}

TEST_CASE("what is not a depth counts as unknown", "[render]") {
  DepthImage depth(5, 1, 1.0f);
  depth(0, 0) = std::numeric_limits<float>::infinity();
  depth(2, 0) = -1.0f;
  depth(4, 0) = 0.0f;
  std::vector<signed char> nearest;
  std::vector<float> filled;
  fill_unknown(depth, nullptr, {0, 0, 5, 1}, 0, nearest, filled);
  CHECK(filled == std::vector<float>{0, 1, 0, 1, 0});
}

TEST_CASE("a depth that is none of the pixel's own counts as unknown", "[render]") {
  DepthImage depth(6, 2, 1.0f);
  depth(3, 1) = depth(4, 1) = 0.5f;
  MaskImage borrowed(6, 2, 0);
  borrowed(3, 1) = borrowed(4, 1) = 255;
  std::vector<signed char> nearest;
  std::vector<float> filled;
  fill_unknown(depth, &borrowed, {1, 1, 5, 1}, 0, nearest, filled);
  CHECK(filled == std::vector<float>{1, 1, 0, 0, 1});
  CHECK(nearest[2] != 0);
  fill_unknown(depth, nullptr, {1, 1, 5, 1}, 0, nearest, filled);
  CHECK(filled == std::vector<float>{1, 1, 0.5f, 0.5f, 1});
}

TEST_CASE("filling again allocates nothing", "[render]") {
  const DepthImage depth(40, 30, kUnknown);
  std::vector<signed char> nearest;
  std::vector<float> filled;
  fill_unknown(depth, nullptr, {0, 0, 40, 30}, 4, nearest, filled);
  CHECK(test::allocations_during([&] {
          fill_unknown(depth, nullptr, {1, 1, 38, 28}, 4, nearest, filled);
        }) == 0);
}
