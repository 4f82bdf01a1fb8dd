#include "palpable/live/track/patch.h"

#include "palpable/live/track/still_watch.h"
#include "tests/support/test.h"

#include <Eigen/LU>

#include <cmath>
#include <random>

namespace palpable {
namespace {

using test::random_case;
using test::tolerance;

// A smooth texture without period, grey levels 40..210.
double texture(double u, double v) {
  return 125 + 35 * std::sin(0.31 * u + 0.11 * v) + 25 * std::sin(0.17 * u - 0.29 * v + 1) +
         25 * std::sin(0.05 * u + 0.41 * v + 2);
}

// The texture seen through the affine map `source_from_image`.
GrayImage picture(int width, int height, const Eigen::Matrix2d& A, const Eigen::Vector2d& t,
                  double gain = 1, double noise = 0, unsigned seed = 0) {
  auto random = random_case(seed);
  std::normal_distribution<double> normal(0, 1);
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Eigen::Vector2d at = A * Eigen::Vector2d(x, y) + t;
      const double value = gain * texture(at.x(), at.y()) + noise * normal(random);
      image(x, y) = static_cast<std::uint8_t>(std::lround(std::min(std::max(value, 0.0), 255.0)));
    }
  }
  return image;
}

const Eigen::Matrix2d kSame = Eigen::Matrix2d::Identity();

TEST_CASE("a patch is found to a few hundredths of a pixel, darker and noisy too", "[track]") {
  const GrayImage first = picture(160, 120, kSame, {0, 0});
  Pyramid pyramid;
  pyramid.build(first);
  const Eigen::Vector2d at(80, 60);
  const PatchSource source = PatchSource::cut(pyramid, at);
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    const Eigen::Vector2d moved(0.37 + 0.2 * seed, -1.21 + 0.1 * seed);
    const GrayImage second = picture(160, 120, kSame, -moved, 0.6, 0.7, seed);
    PatchTemplate look;
    REQUIRE(look.warp(source, 0, kSame, {0, 0}));
    const PatchMatch match = follow(second, look, at);
    REQUIRE(match.found);
    CHECK((match.at - at - moved).norm() <=
          tolerance(0.06, "rounding to whole levels and 0.7 levels of noise on 144 pixels"));
    CHECK(match.likeness > 0.98);
  }
}

TEST_CASE("a patch that is turned and zoomed is found through its warp, not without", "[track]") {
  const GrayImage first = picture(200, 200, kSame, {0, 0});
  Pyramid pyramid;
  pyramid.build(first);
  const Eigen::Vector2d at(100, 100);
  const PatchSource source = PatchSource::cut(pyramid, at);
  Eigen::Matrix2d image_from_source;
  image_from_source << 1.2, -0.5, 0.45, 1.1;
  // at stays at: source = A^-1 (image - at) + at
  const Eigen::Matrix2d back = image_from_source.inverse();
  const GrayImage second = picture(200, 200, back, at - back * at);
  PatchTemplate warped, plain;
  REQUIRE(warped.warp(source, 0, image_from_source, {0, 0}));
  const PatchMatch match = follow(second, warped, at + Eigen::Vector2d(1.2, -0.8));
  REQUIRE(match.found);
  CHECK((match.at - at).norm() <= tolerance(0.05, "bilinear samples of a texture of 15 px"));
  REQUIRE(plain.warp(source, 0, kSame, {0, 0}));
  CHECK(likeness_at(second, plain, at) < 0.9);
  CHECK(match.likeness > 0.99);
}

TEST_CASE("a smeared picture is like a smeared patch", "[track]") {
  const GrayImage first = picture(160, 120, kSame, {0, 0});
  Pyramid pyramid;
  pyramid.build(first);
  const Eigen::Vector2d at(80, 60);
  const PatchSource source = PatchSource::cut(pyramid, at);
  const Eigen::Vector2d smear(12, 6);
  GrayImage second(160, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      double sum = 0;
      for (int k = 0; k < 32; ++k) {
        const Eigen::Vector2d s = ((k + 0.5) / 32 - 0.5) * smear;
        sum += texture(x + s.x(), y + s.y());
      }
      second(x, y) = static_cast<std::uint8_t>(std::lround(sum / 32));
    }
  }
  PatchTemplate sharp, smeared;
  REQUIRE(sharp.warp(source, 0, kSame, {0, 0}));
  REQUIRE(smeared.warp(source, 0, kSame, smear));
  CHECK(likeness_at(second, smeared, at) > 0.99);
  CHECK(likeness_at(second, smeared, at) > likeness_at(second, sharp, at) + 0.03);
}

TEST_CASE("a blank patch and one at the border are not followed", "[track]") {
  const GrayImage blank(100, 100, 90);
  Pyramid pyramid;
  pyramid.build(blank);
  PatchTemplate look;
  CHECK_FALSE(look.warp(PatchSource::cut(pyramid, {50, 50}), 0, kSame, {0, 0}));
  const GrayImage image = picture(100, 100, kSame, {0, 0});
  pyramid.build(image);
  CHECK_FALSE(look.warp(PatchSource::cut(pyramid, {3, 50}), 0, kSame, {0, 0}));
  REQUIRE(look.warp(PatchSource::cut(pyramid, {50, 50}), 0, kSame, {0, 0}));
  CHECK_FALSE(follow(image, look, {2, 50}).found);
  CHECK(likeness_at(image, look, {98, 50}) == -1);
}

TEST_CASE("a standing camera stands, whatever hand moves before it; a moved one has moved",
          "[track]") {
  StillWatch watch;
  const DepthImage depth(320, 180, 1.0F);
  watch.begin(picture(640, 360, kSame, {0, 0}, 1, 0.7, 1), depth);
  CHECK(watch.look(picture(640, 360, kSame, {0, 0}, 1, 0.7, 2), depth, nullptr) ==
        Stillness::kStill);
  CHECK(watch.look(picture(640, 360, kSame, {0, 0}, 0.5, 0.7, 3), depth, nullptr) ==
        Stillness::kStill);
  GrayImage hand = picture(640, 360, kSame, {0, 0}, 1, 0.7, 4);
  const GrayImage other = picture(640, 360, 1.3 * kSame, {9, 4}, 0.8, 0.7, 5);
  for (int y = 60; y < 360; ++y) {
    for (int x = 200; x < 510; ++x) hand(x, y) = other(x, y);  // 40 % of the view
  }
  CHECK(watch.look(hand, depth, nullptr) == Stillness::kStill);
  CHECK(watch.look(picture(640, 360, kSame, {0.6, 0.2}, 1, 0.7, 6), depth, nullptr) ==
        Stillness::kMoved);
  CHECK(watch.look(GrayImage(640, 360, 4), depth, nullptr) == Stillness::kUnclear);
}

}  // namespace
}  // namespace palpable
