#include "palpable/live/track/still_watch.h"

#include "tests/support/noise_room.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace palpable {
namespace {

constexpr int kWidth = 320, kHeight = 240;

// A sum of waves, 9 to 23 px long, seen through x -> turn * (x - middle) + shift + middle.
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
  watch.begin(image, DepthImage(kWidth / 2, kHeight / 2, 1.0F));
  return watch;
}

Stillness look(const StillWatch& watch, const GrayImage& image, const MaskImage* moving = nullptr,
               float depth = 1) {
  return watch.look(image, DepthImage(kWidth / 2, kHeight / 2, depth), moving);
}

TEST_CASE("a camera stands while its picture has moved by less than 0.3 px, to whatever side",
          "[track][still]") {
  const StillWatch watch = watch_of(picture());
  REQUIRE(watch.begun());
  CHECK(look(watch, picture()) == Stillness::kStill);
  CHECK(look(watch, picture(0.2, -0.2)) == Stillness::kStill);
  CHECK(look(watch, picture(0.4, 0)) == Stillness::kMoved);
  CHECK(look(watch, picture(0, -0.4)) == Stillness::kMoved);
}

TEST_CASE("a camera that goes straight ahead or rolls does not stand", "[track][still]") {
  const StillWatch watch = watch_of(picture());
  // Half of the picture is more than 110 px from its middle, and moves by more than 0.55 px.
  for (const double growth : {-0.005, 0.005}) {
    CHECK(look(watch, picture({0, 0}, (1 + growth) * Eigen::Matrix2d::Identity())) ==
          Stillness::kMoved);
    CHECK(look(watch, picture({0, 0}, Eigen::Rotation2Dd(growth).toRotationMatrix())) ==
          Stillness::kMoved);
  }
}

TEST_CASE("a bare picture is watched by the little that it shows", "[track][still]") {
  // White, except for a square of 56 x 56 px where four of the 8 x 6 cells meet.
  const auto bare = [](double dx, double dy) {
    const GrayImage all = picture(dx, dy);
    GrayImage image(kWidth, kHeight, 200);
    for (int y = 92; y < 148; ++y) std::copy_n(all.row(y) + 92, 56, image.row(y) + 92);
    return image;
  };
  const StillWatch watch = watch_of(bare(0, 0));
  CHECK(look(watch, bare(0, 0)) == Stillness::kStill);
  CHECK(look(watch, bare(0.2, 0)) == Stillness::kStill);
  CHECK(look(watch, bare(0.4, 0)) == Stillness::kMoved);
  CHECK(look(watch, bare(0, 0.4)) == Stillness::kMoved);
  // A hand covers it, and the rest cannot be compared.
  MaskImage mask(kWidth, kHeight);
  for (int y = 90; y < 150; ++y) std::fill_n(mask.row(y) + 90, 60, std::uint8_t{255});
  CHECK(look(watch, bare(0, 0), &mask) == Stillness::kUnclear);
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
    CHECK(look(watch, noisy) == Stillness::kStill);
  }
}

TEST_CASE("what hides most patches says neither that it stands nor that it moves",
          "[track][still]") {
  const GrayImage empty = picture(), hand = picture({0, 0}, Eigen::Matrix2d::Identity(), 2);
  const StillWatch watch = watch_of(empty);
  // Hides `columns` of the 8 columns of patches, from the left.
  const auto hidden = [&](int columns, bool masked) {
    GrayImage image = empty;
    MaskImage mask(kWidth / 2, kHeight / 2);
    for (int y = 0; y < kHeight; ++y) {
      std::copy_n(hand.row(y), columns * kWidth / 8, image.row(y));
      std::fill_n(mask.row(y / 2), columns * kWidth / 16, std::uint8_t{255});
    }
    return look(watch, image, masked ? &mask : nullptr);
  };
  CHECK(hidden(4, false) == Stillness::kStill);
  CHECK(hidden(4, true) == Stillness::kStill);
  CHECK(hidden(7, true) == Stillness::kUnclear);  // 6 patches are left, 10 are needed
  CHECK(look(watch, GrayImage(kWidth, kHeight, 3)) == Stillness::kUnclear);
}

TEST_CASE("another view as far away is told from darkness and from what hides the view",
          "[track][still]") {
  // Waves could be matched one wavelength away, so the texture is noise.
  const auto noise = [](unsigned wall) {
    GrayImage image(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        image(x, y) = static_cast<std::uint8_t>(test::wall_texture(x / 100.0, y / 100.0, wall));
      }
    }
    return image;
  };
  const StillWatch watch = watch_of(noise(1));
  const GrayImage other = noise(2);
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  CHECK(look(watch, other) == Stillness::kOtherView);
  CHECK(look(watch, other, nullptr, 3) == Stillness::kOtherView);
  CHECK(look(watch, other, nullptr, 0.3F) == Stillness::kUnclear);      // a hand
  CHECK(look(watch, other, nullptr, kUnknown) == Stillness::kUnclear);  // too near to be measured
  GrayImage faded = other;
  for (std::uint8_t& y : faded) y = static_cast<std::uint8_t>(y / 5);
  CHECK(look(watch, faded) == Stillness::kUnclear);
}

}  // namespace
}  // namespace palpable
