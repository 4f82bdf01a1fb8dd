#include "palpable/live/seen_object/pixel_kernels.h"

#include "tests/support/test.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace palpable {
namespace {

constexpr DepthJump kJump{0.008f, 0.04f};

// Three rows of a thing with steps and holes in it, laid out as in Silhouette. Before and after
// each row there are exactly as many elements as the kernels may read.
struct Rows {
  explicit Rows(int count, unsigned seed)
      : stride(static_cast<std::size_t>(count) + 1 + kReadBeyond) {
    auto random = test::random_case(seed);
    std::uniform_real_distribution<float> share(0, 1);
    std::uniform_int_distribution<int> way(-12, 12);
    for (std::vector<float>* of : {&distance, &beyond, &depth, &mean}) of->resize(3 * stride);
    nearest.resize(3 * stride);
    for (std::size_t k = 0; k < 3 * stride; ++k) {
      // Neighbours are mostly of one surface.
      depth[k] = 0.4f + 0.004f * share(random) + (share(random) < 0.1f ? 0.03f : 0.0f);
      nearest[k] = {static_cast<std::int16_t>(way(random)), static_cast<std::int16_t>(way(random))};
      distance[k] =
          std::hypot(static_cast<float>(nearest[k].dx), static_cast<float>(nearest[k].dy));
      beyond[k] = share(random) < 0.3f ? share(random) - 0.5f : 0.0f;
      if (share(random) < 0.2f) distance[k] = std::numeric_limits<float>::infinity();
      mean[k] = 1 / depth[k];
      if (share(random) < 0.15f) {
        distance[k] = 0, mean[k] = 0, depth[k] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
  [[nodiscard]] OutlineRow outline(int row) {
    const std::size_t n = at(row);
    return {&distance[n], &nearest[n], &beyond[n], &depth[n]};
  }
  [[nodiscard]] DistanceRow seen(int row) const { return {&distance[at(row)], &depth[at(row)]}; }
  [[nodiscard]] std::size_t at(int row) const { return static_cast<std::size_t>(row) * stride + 1; }

  std::size_t stride;
  std::vector<float> distance, beyond, depth, mean;
  std::vector<ToOutline> nearest;
};

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

// Numbers of pixels below, at and above the lengths of vectors.
constexpr int kCounts[] = {0, 1, 3, 4, 7, 8, 9, 15, 16, 17, 40, 63};

TEST_CASE("outlines are propagated to the same bytes by every kernel", "[seen_object][kernels]") {
  for (const int count : kCounts) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      Rows plain(count, seed);
      const std::vector<float> before = plain.distance;
      pixel_kernels().back().take_over(plain.outline(0), plain.outline(1), -1, count, kJump);
      if (count > 15) CHECK_FALSE(same_bytes(plain.distance, before));
      for (const PixelKernels& kernels : pixel_kernels()) {
        INFO(kernels.name << ", " << count << " px, seed " << seed);
        Rows rows(count, seed);
        kernels.take_over(rows.outline(0), rows.outline(1), -1, count, kJump);
        CHECK(same_bytes(rows.distance, plain.distance));
        CHECK(same_bytes(rows.beyond, plain.beyond));
        CHECK(same_bytes(rows.nearest, plain.nearest));
      }
    }
  }
}

TEST_CASE("inverse depths are averaged to the same bytes by every kernel",
          "[seen_object][kernels]") {
  for (const int count : kCounts) {
    const Rows rows(count, 7);
    std::vector<float> plain(static_cast<std::size_t>(count) + 1), mean(plain.size());
    const float* middle = &rows.mean[rows.at(1)];
    const auto of = [&](const PixelKernels& kernels, std::vector<float>& result) {
      kernels.mean_of_nine(middle - rows.stride, middle, middle + rows.stride, count, kJump,
                           result.data());
    };
    of(pixel_kernels().back(), plain);
    for (const PixelKernels& kernels : pixel_kernels()) {
      INFO(kernels.name << ", " << count << " px");
      of(kernels, mean);
      CHECK(same_bytes(mean, plain));
    }
  }
}

TEST_CASE("a window is summed up to the same bytes by every kernel", "[seen_object][kernels]") {
  for (const int columns : {1, 4, 5, 8, 11, 12}) {
    for (const float radius : {0.0f, 0.008f}) {
      const Rows rows(columns, 11);
      PixelWindow window;
      window.depth = rows.seen(0).depth, window.distance = rows.seen(0).distance;
      window.stride = rows.stride;
      window.columns = columns;
      window.top = -2, window.bottom = 0;
      window.z = 0.402f;
      window.least = 1.9f;
      window.radius = radius;
      window.fattening = 1;
      window.m_per_px = 0.0012f;
      ColumnSums plain, sums;
      pixel_kernels().back().sum_window(window, kJump, plain);
      float counted = 0;
      for (const float n : plain.n) counted += n;
      CHECK(counted > static_cast<float>(columns));
      CHECK(counted < 3 * static_cast<float>(columns) + 1);
      for (const PixelKernels& kernels : pixel_kernels()) {
        INFO(kernels.name << ", " << columns << " columns, radius " << radius);
        kernels.sum_window(window, kJump, sums);
        CHECK(std::memcmp(&sums, &plain, sizeof(sums)) == 0);
      }
    }
  }
}

TEST_CASE("every kernel finds the same pixels for balls", "[seen_object][kernels]") {
  MiddleTest test;
  test.growth = 0.95f;
  test.fattening = 1;
  test.f_r = 4.25f;
  test.r = 0.0125f;
  for (const int count : kCounts) {
    const Rows rows(count, 13);
    std::vector<float> plain(static_cast<std::size_t>(count) + 1), found(plain.size());
    const auto of = [&](const PixelKernels& kernels, std::vector<float>& result) {
      kernels.find_middles(rows.seen(0), rows.seen(1), rows.seen(2), count, kJump, test,
                           result.data());
    };
    of(pixel_kernels().back(), plain);
    for (const PixelKernels& kernels : pixel_kernels()) {
      INFO(kernels.name << ", " << count << " px");
      of(kernels, found);
      CHECK(same_bytes(found, plain));
    }
  }
}

// A vectorised kernel may return more pixels where neighbouring chords have different lengths.
TEST_CASE("no kernel misses a pixel that may be concave", "[seen_object][kernels]") {
  constexpr int kRows = 17, kWidth = 60;
  const auto row = [](int y) { return static_cast<std::size_t>(y) * std::size_t{kWidth}; };
  auto random = test::random_case(17);
  std::uniform_real_distribution<float> noise(-0.001f, 0.001f);
  std::vector<float> mean(kRows * kWidth), distance(mean.size(), 30.0f);
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      // A valley along x = 30, in a surface that is farther away on the right, with shorter chords.
      const float z = 0.4f - 0.0006f * std::abs(static_cast<float>(x - 30)) + noise(random) +
                      0.003f * static_cast<float>(x);
      mean[row(y) + static_cast<std::size_t>(x)] = 1 / z;
    }
  }
  ChordTest chord;
  chord.half_px_at_1m = 1.42f;
  chord.nearest_at_1m = 1.42f;
  chord.least_half_px = 2;
  chord.fx_px = 340;
  chord.eight_radii = 0.1f;
  int places = 0, hollow = 0;
  for (int y = 0; y < kRows; ++y) {
    chord.above = y, chord.below = kRows - 1 - y;
    const auto of = [&](const PixelKernels& kernels, std::vector<float>& result) {
      kernels.find_hollow(&mean[row(y)], &distance[row(y)], kWidth, kWidth, chord, result.data());
    };
    std::vector<float> plain(kWidth), found(kWidth);
    of(pixel_kernels().back(), plain);
    for (const PixelKernels& kernels : pixel_kernels()) {
      INFO(kernels.name << ", row " << y);
      of(kernels, found);
      for (std::size_t x = 0; x < kWidth; ++x) CHECK(found[x] >= plain[x]);
    }
    for (const float value : plain) ++places, hollow += value > 0 ? 1 : 0;
  }
  CHECK(hollow > 0);
  CHECK(hollow < places);
}

}  // namespace
}  // namespace palpable
