#include "palpable/live/map/mask_outline.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr int kGrow = 3;
const float kNaN = std::nanf("");

// A wall at 1 m; tiles are sampled in their middle.
struct Picture {
  explicit Picture(int w = 160, int h = 90) : width(w), height(h), depth(w, h, 1.0F) {
    outline.resize(width, height);
    tile_depth = DepthImage((width + kTile - 1) / kTile, (height + kTile - 1) / kTile);
    moves = Image<std::uint8_t>(tile_depth.width(), tile_depth.height());
  }
  void cover(int x0, int y0, int x1, int y1, float Z) {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) depth(x, y) = Z;
    }
  }
  // Tiles that are nearer than 0.5 m move.
  const MaskImage& draw() {
    for (int j = 0; j < moves.height(); ++j) {
      for (int i = 0; i < moves.width(); ++i) {
        const int x = kTile * i + 2, y = kTile * j + 2;
        tile_depth(i, j) = x < width && y < height ? depth(x, y) : kNaN;
        moves(i, j) = tile_depth(i, j) < 0.5F ? 1 : 0;
      }
    }
    return outline.draw(depth, tile_depth, moves, {});
  }
  int width, height;
  MaskOutline outline{kGrow};
  DepthImage depth, tile_depth;
  Image<std::uint8_t> moves;
};

// Number of pixels of the mask that are wrong.
template <typename Inside>
int wrong(const MaskImage& mask, const Inside& inside) {
  int count = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      count += (mask(x, y) != 0) != inside(x, y) ? 1 : 0;
      if (mask(x, y) != 0) REQUIRE(mask(x, y) == 255);
    }
  }
  return count;
}

TEST_CASE("the mask follows the edge of the depth to the pixel", "[map][mask_outline]") {
  // The object begins and ends in the middle of tiles; the picture's last tiles are incomplete.
  Picture picture(161, 91);
  picture.cover(33, 21, 95, 70, 0.4F);
  const MaskImage& mask = picture.draw();
  CHECK(wrong(mask, [](int x, int y) { return x >= 33 && x < 95 && y >= 21 && y < 70; }) == 0);
}

TEST_CASE("tiles beside moving ones are marked", "[map][mask_outline]") {
  Picture picture;
  picture.cover(32, 20, 64, 40, 0.4F);
  picture.draw();
  const Image<std::uint8_t>& near = picture.outline.near_moving();
  CHECK(near(7, 4) == 1);
  CHECK(near(6, 4) == 0);
  CHECK(std::count(near.begin(), near.end(), 1) == (8 + 2) * (5 + 2));
}

TEST_CASE("a hole without depth is closed, a strip beside the border by a margin",
          "[map][mask_outline]") {
  Picture picture;
  picture.cover(40, 20, 120, 80, 0.4F);
  picture.cover(60, 40, 70, 50, kNaN);  // inside
  picture.cover(34, 20, 40, 80, kNaN);  // the strip that only the left eye sees
  const MaskImage& mask = picture.draw();
  CHECK(wrong(mask, [](int x, int y) { return x >= 40 - kGrow && x < 120 && y >= 20 && y < 80; }) ==
        0);
}

TEST_CASE("a hole that is too wide along its row is closed along its columns",
          "[map][mask_outline]") {
  Picture picture;
  picture.cover(40, 20, 120, 80, 0.4F);
  // The hole is two pixels high, so that the tiles around it are border tiles only because of it.
  for (int x = 60; x < 100; ++x) picture.cover(x, 42, x + 1, 43, kNaN);
  const MaskImage& mask = picture.draw();
  CHECK(wrong(mask, [](int x, int y) { return x >= 40 && x < 120 && y >= 20 && y < 80; }) == 0);
}

TEST_CASE("nothing is left of the previous mask", "[map][mask_outline]") {
  Picture picture;
  picture.cover(30, 20, 90, 60, 0.4F);
  picture.draw();
  picture.cover(30, 20, 90, 60, 1.0F);
  picture.cover(4, 70, 40, 90, 0.4F);  // other rows, down to the picture's end
  const MaskImage& mask = picture.draw();
  CHECK(wrong(mask, [](int x, int y) { return x >= 4 && x < 40 && y >= 70; }) == 0);
  picture.cover(4, 70, 40, 90, 1.0F);
  CHECK(wrong(picture.draw(), [](int, int) { return false; }) == 0);
}

TEST_CASE("a margin is not negative", "[map][mask_outline]") {
  CHECK_THROWS_AS(MaskOutline(-1), ContractViolation);
}

}  // namespace
}  // namespace palpable
