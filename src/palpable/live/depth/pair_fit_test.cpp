#include "palpable/live/depth/pair_fit.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <random>

namespace palpable {
namespace {

constexpr int kWidth = 200;
constexpr int kHeight = 120;

// A textured wall at a disparity of `disparity` px; the right image is lower by `rows` px.
struct Pair {
  GrayImage left, right;
};
Pair seen(int disparity, int rows, unsigned seed) {
  GrayImage wall(kWidth + 200, kHeight + 100);
  auto random = test::random_case(seed);
  for (std::uint8_t& p : wall) p = static_cast<std::uint8_t>(60 + random() % 120);
  std::normal_distribution<double> noise(0, 0.7);
  Pair pair{GrayImage(kWidth, kHeight), GrayImage(kWidth, kHeight)};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto grey = [&](int u, int v, int brighter) {
        return static_cast<std::uint8_t>(wall(u, v) + brighter + std::lround(noise(random)));
      };
      pair.left(x, y) = grey(x + 100, y + 50, 0);
      pair.right(x, y) = grey(x + 100 + disparity, y + 50 - rows, 8);
    }
  }
  return pair;
}

TEST_CASE("a pair whose rows fit is no misfit, wherever its wall stands", "[depth][pair]") {
  for (const int disparity : {0, 7, 40}) {
    INFO("disparity " << disparity);
    const Pair pair = seen(disparity, 0, 1);
    CHECK_FALSE(misfit_of(pair.left, pair.right, 0, 50));
  }
  const Pair pair = seen(7 - 12, 0, 2);  // 12 px at infinity, the other way
  CHECK_FALSE(misfit_of(pair.left, pair.right, -12, 50));
}

TEST_CASE("rows that are far apart are measured, up and down", "[depth][pair]") {
  for (const int rows : {3, -9, 20}) {
    const Pair pair = seen(15, rows, 3);
    const auto misfit = misfit_of(pair.left, pair.right, 0, 50);
    REQUIRE(misfit);
    CHECK_FALSE(misfit->swapped);
    CHECK(misfit->rows_px == rows);
    const std::string message = misfit->message();
    CHECK(message.find(std::to_string(std::abs(rows)) + " px apart") != std::string::npos);
    CHECK(message.find("palpable calibrate") != std::string::npos);
  }
}

TEST_CASE("one row is the row watch's to correct", "[depth][pair]") {
  const Pair pair = seen(15, 1, 4);
  CHECK_FALSE(misfit_of(pair.left, pair.right, 0, 50));
}

TEST_CASE("swapped eyes are called so, with rows that fit or not", "[depth][pair]") {
  for (const int rows : {0, 6}) {
    const Pair pair = seen(-15, rows, 5);
    const auto misfit = misfit_of(pair.left, pair.right, 0, 50);
    REQUIRE(misfit);
    CHECK(misfit->swapped);
    CHECK(misfit->message().find("swapped") != std::string::npos);
  }
}

TEST_CASE("plain walls, noise and different scenes are no evidence of a misfit", "[depth][pair]") {
  const GrayImage plain(kWidth, kHeight, 90);
  CHECK_FALSE(misfit_of(plain, plain, 0, 50));
  CHECK_FALSE(misfit_of(seen(5, 8, 6).left, seen(5, 8, 7).right, 0, 50));
  const GrayImage tiny(40, 30, 90);
  CHECK_FALSE(misfit_of(tiny, tiny, 0, 10));
  CHECK_THROWS_AS(misfit_of(plain, tiny, 0, 50), ContractViolation);
}

}  // namespace
}  // namespace palpable
