#include "palpable/live/track/start_watch.h"

#include "tests/support/noise_room.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace palpable {
namespace {

constexpr int kWidth = 320, kHeight = 180;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
const DepthNoise kNoise{0.001, 0, 0.002};

GrayImage bare(std::uint8_t luma = 120) { return {kWidth, kHeight, luma}; }

// A view that is shifted by `u` px to the right of the first one.
GrayImage picture(double u = 0) {
  GrayImage image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image(x, y) = static_cast<std::uint8_t>(test::wall_texture((x + u) / 100, y / 100.0, 1));
    }
  }
  return image;
}

// The depth image, of half the size, of a floor that is `nearer` m nearer.
DepthImage floor_depth(float nearer = 0, unsigned seed = 0) {
  DepthImage depth(kWidth / 2, kHeight / 2);
  std::mt19937_64 random = test::random_case(seed);
  std::normal_distribution<float> noise;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const float Z = 1.5F - 0.008F * static_cast<float>(y) - nearer;
      depth(x, y) = Z + kNoise.sigma_in_float(Z) * noise(random);
    }
  }
  return depth;
}

DepthImage unknown_depth() { return {kWidth / 2, kHeight / 2, kUnknown}; }

TEST_CASE("before a bare wall the depths tell whether the camera stands", "[track][start]") {
  StartWatch watch(kNoise);
  for (unsigned n = 0; n < 5; ++n) {
    CHECK(watch.look(bare(), floor_depth(0, n)) == Stillness::kStill);
  }
  CHECK(watch.look(bare(), floor_depth(0.05F, 9)) == Stillness::kMoved);
  CHECK(watch.look(bare(), floor_depth(-0.05F, 9)) == Stillness::kMoved);
  CHECK(watch.look(bare(), floor_depth(0, 10)) == Stillness::kStill);  // it is back

  // Something covers 40 % of the view, then 60 %.
  for (const bool most : {false, true}) {
    DepthImage hand = floor_depth(0, 11);
    const int columns = hand.width() * (most ? 6 : 4) / 10;
    for (int y = 0; y < hand.height(); ++y) std::fill_n(hand.row(y), columns, 0.4F);
    CHECK(watch.look(bare(), hand) == (most ? Stillness::kMoved : Stillness::kStill));
  }
}

TEST_CASE("what the picture says counts for more than the depths", "[track][start]") {
  StartWatch watch(kNoise);
  CHECK(watch.look(picture(), floor_depth()) == Stillness::kStill);
  CHECK(watch.look(picture(2), floor_depth()) == Stillness::kMoved);
  CHECK(watch.look(picture(), floor_depth(0.2F)) == Stillness::kStill);
  CHECK(watch.look(bare(), floor_depth()) == Stillness::kStill);  // no texture: by depth
}

TEST_CASE("the result is unclear until a view can be compared, the first of which is the reference",
          "[track][start]") {
  StartWatch watch(kNoise);
  CHECK(watch.look(bare(0), unknown_depth()) == Stillness::kUnclear);
  CHECK(watch.look(bare(0), floor_depth(0.3F)) == Stillness::kStill);
  CHECK(watch.look(bare(0), unknown_depth()) == Stillness::kUnclear);
  CHECK(watch.look(bare(0), floor_depth()) == Stillness::kMoved);
}

}  // namespace
}  // namespace palpable
