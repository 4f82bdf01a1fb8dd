#include "palpable/track/still_watch.h"

#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace palpable {
namespace {

constexpr int kWidth = 320, kHeight = 240;

// A plain of waves, 9 to 23 px long, seen through x -> turn * (x - middle) + shift + middle.
GrayImage picture(const Eigen::Vector2d& shift, const Eigen::Matrix2d& turn, double seed = 0) {
  GrayImage image(kWidth, kHeight);
  const Eigen::Vector2d middle(0.5 * (kWidth - 1), 0.5 * (kHeight - 1));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector2d p = turn * (Eigen::Vector2d(x, y) - middle) - shift;
      const double value = std::sin(0.61 * p.x() + 0.2 * p.y() + seed) +
                           std::sin(0.27 * p.y() - 0.11 * p.x()) * std::cos(0.31 * p.x() + seed) +
                           std::sin(0.55 * p.y() + 0.07 * p.x());
      image(x, y) = static_cast<std::uint8_t>(std::lround(128 + 35 * value));
    }
  }
  return image;
}
GrayImage picture(double dx = 0, double dy = 0) {
  return picture({dx, dy}, Eigen::Matrix2d::Identity());
}

StillWatch watch_of(const GrayImage& image) {
  StillWatch watch;
  watch.begin(image);
  return watch;
}

TEST_CASE("a camera stands while its picture has moved by less than 0.3 px, to whatever side",
          "[track][still]") {
  const StillWatch watch = watch_of(picture());
  REQUIRE(watch.begun());
  CHECK(watch.look(picture(), nullptr) == Stillness::kStill);
  CHECK(watch.look(picture(0.2, -0.2), nullptr) == Stillness::kStill);
  CHECK(watch.look(picture(0.4, 0), nullptr) == Stillness::kMoved);
  CHECK(watch.look(picture(0, -0.4), nullptr) == Stillness::kMoved);
}

TEST_CASE("a camera that goes straight ahead or rolls does not stand", "[track][still]") {
  const StillWatch watch = watch_of(picture());
  // Half of the picture lies more than 110 px from its middle: 0.55 px.
  for (const double growth : {-0.005, 0.005}) {
    CHECK(watch.look(picture({0, 0}, (1 + growth) * Eigen::Matrix2d::Identity()), nullptr) ==
          Stillness::kMoved);
    CHECK(watch.look(picture({0, 0}, Eigen::Rotation2Dd(growth).toRotationMatrix()), nullptr) ==
          Stillness::kMoved);
  }
}

TEST_CASE("a bare picture is watched by the little that it shows", "[track][still]") {
  // White, but for a place of 56 x 56 px where four of the 8 x 6 cells meet.
  const auto bare = [](double dx, double dy) {
    const GrayImage all = picture(dx, dy);
    GrayImage image(kWidth, kHeight, 200);
    for (int y = 92; y < 148; ++y) std::copy_n(all.row(y) + 92, 56, image.row(y) + 92);
    return image;
  };
  const StillWatch watch = watch_of(bare(0, 0));
  CHECK(watch.look(bare(0, 0), nullptr) == Stillness::kStill);
  CHECK(watch.look(bare(0.2, 0), nullptr) == Stillness::kStill);
  CHECK(watch.look(bare(0.4, 0), nullptr) == Stillness::kMoved);
  CHECK(watch.look(bare(0, 0.4), nullptr) == Stillness::kMoved);
  // A hand over it: what is left says nothing.
  MaskImage mask(kWidth, kHeight);
  for (int y = 90; y < 150; ++y) std::fill_n(mask.row(y) + 90, 60, std::uint8_t{255});
  CHECK(watch.look(bare(0, 0), &mask) == Stillness::kUnclear);
  CHECK_FALSE(watch_of(GrayImage(kWidth, kHeight, 200)).begun());
}

TEST_CASE("noise is no motion", "[track][still]") {
  const StillWatch watch = watch_of(picture());
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    std::mt19937_64 random = test::random_case(seed);
    std::normal_distribution<double> noise(0, 4);
    GrayImage noisy = picture();
    for (std::uint8_t& y : noisy) {
      y = static_cast<std::uint8_t>(std::clamp(std::lround(y + noise(random)), 0L, 255L));
    }
    CHECK(watch.look(noisy, nullptr) == Stillness::kStill);
  }
}

TEST_CASE("what hides most patches says neither that it stands nor that it moves",
          "[track][still]") {
  const GrayImage empty = picture(), hand = picture({0, 0}, Eigen::Matrix2d::Identity(), 2);
  const StillWatch watch = watch_of(empty);
  // Of 8 x 6 patches so many columns are hidden, from the left.
  const auto hidden = [&](int columns, bool masked) {
    GrayImage image = empty;
    MaskImage mask(kWidth / 2, kHeight / 2);
    for (int y = 0; y < kHeight; ++y) {
      std::copy_n(hand.row(y), columns * kWidth / 8, image.row(y));
      std::fill_n(mask.row(y / 2), columns * kWidth / 16, std::uint8_t{255});
    }
    return watch.look(image, masked ? &mask : nullptr);
  };
  CHECK(hidden(4, false) == Stillness::kStill);
  CHECK(hidden(4, true) == Stillness::kStill);
  CHECK(hidden(7, true) == Stillness::kUnclear);  // 6 patches are left of the 10 that it takes
  CHECK(watch.look(GrayImage(kWidth, kHeight, 3), nullptr) == Stillness::kUnclear);
}

}  // namespace
}  // namespace palpable
