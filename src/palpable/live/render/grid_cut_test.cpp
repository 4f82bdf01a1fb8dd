#include "palpable/live/render/grid_cut.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <limits>
#include <random>
#include <vector>

namespace palpable {
namespace {

// The costs of a grid, and the cost of a division.
struct Costs {
  int width, height;
  std::vector<int> bias, right, down;  // one of each per pixel; links that leave the grid are 0

  Costs(unsigned seed, int w, int h, int most) : width(w), height(h) {
    auto random = test::random_case(seed);
    std::uniform_int_distribution<int> wish(-most, most), link(0, most);
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        bias.push_back(wish(random));
        right.push_back(x + 1 < w ? link(random) : 0);
        down.push_back(y + 1 < h ? link(random) : 0);
      }
    }
  }

  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }

  void put_into(GridCut& cut) const {
    cut.begin(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto i = place(x, y);
        cut.add_bias(x, y, bias[i]);
        if (x + 1 < width) cut.link_right(x, y, right[i]);
        if (y + 1 < height) cut.link_down(x, y, down[i]);
      }
    }
  }

  template <class Side>
  [[nodiscard]] long of(const Side& side) const {
    long sum = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto i = place(x, y);
        if (side(x, y) ? bias[i] < 0 : bias[i] > 0) sum += std::abs(bias[i]);
        if (x + 1 < width && side(x, y) != side(x + 1, y)) sum += right[i];
        if (y + 1 < height && side(x, y) != side(x, y + 1)) sum += down[i];
      }
    }
    return sum;
  }
};

TEST_CASE("a cut has the least cost of all divisions, with the fewest pixels on side 1",
          "[render][outlines]") {
  GridCut cut;
  for (unsigned seed = 0; seed < 60; ++seed) {
    INFO("seed " << seed);
    const int width = 2 + static_cast<int>(seed % 3), height = 3;
    const Costs costs(seed, width, height, seed % 2 == 0 ? 3 : 40);  // small costs make ties
    costs.put_into(cut);
    cut.solve();
    long best = std::numeric_limits<long>::max();
    int fewest = 0;
    for (int division = 0; division < 1 << (width * height); ++division) {
      const auto side = [&](int x, int y) { return (division >> (y * width + x) & 1) != 0; };
      const long cost = costs.of(side);
      const int count = __builtin_popcount(static_cast<unsigned>(division));
      if (cost < best || (cost == best && count < fewest)) {
        best = cost;
        fewest = count;
      }
    }
    int count = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) count += cut.side(x, y) ? 1 : 0;
    }
    CHECK(costs.of([&](int x, int y) { return cut.side(x, y); }) == best);
    CHECK(count == fewest);
  }
}

TEST_CASE("no change of a pixel or of a row makes a cut of a larger grid cheaper",
          "[render][outlines][law]") {
  GridCut cut;
  for (unsigned seed = 0; seed < 8; ++seed) {
    INFO("seed " << seed);
    const Costs costs(seed, 37, 23, 100);
    costs.put_into(cut);
    cut.solve();
    const long least = costs.of([&](int x, int y) { return cut.side(x, y); });
    for (int v = 0; v < costs.height; ++v) {
      for (int u = 0; u <= costs.width; ++u) {  // u == width: the whole row
        const long other = costs.of([&](int x, int y) {
          return cut.side(x, y) != (y == v && (x == u || u == costs.width));
        });
        REQUIRE(other >= least);
      }
    }
  }
}

TEST_CASE("a cut of a size that was seen before takes no memory", "[render][outlines]") {
  const Costs costs(1, 40, 30, 100);
  GridCut cut;
  const auto solve = [&] {
    costs.put_into(cut);
    cut.solve();
  };
  solve();
  CHECK(test::allocations_during(solve) == 0);
  cut.begin(0, 0);
  cut.solve();  // nothing to divide
}

}  // namespace
}  // namespace palpable
