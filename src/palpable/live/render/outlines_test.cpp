#include "palpable/live/render/outlines.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace palpable {
namespace {

constexpr int kWidth = 141;  // of the depth image, px
constexpr int kHeight = 103;
constexpr float kHand = 0.35f;  // m
constexpr float kDesk = 0.5f;
constexpr float kBody = 0.42f;  // between them
constexpr Rgb kSkin{224, 176, 150};
constexpr Rgb kWood{187, 146, 104};

// A desk and a near thing before it, with the depth of a matcher that widens near things.
struct Case {
  ColorImage picture{2 * kWidth + 1, 2 * kHeight, kWood};
  MaskImage truth{2 * kWidth, 2 * kHeight, 0};  // 255 on the near thing
  std::vector<float> depth = std::vector<float>(kWidth * kHeight, kDesk);
  std::vector<signed char> guessed = std::vector<signed char>(kWidth * kHeight, 0);
  PixelBox box{0, 0, kWidth, kHeight};
  PixelBox inner = PixelBox::between(30, 30, kWidth - 31, kHeight - 32);
  std::vector<float> body = std::vector<float>(4 * (kWidth - 61) * (kHeight - 62), kBody);
  MaskImage moving, too_close;  // empty: not known

  // @param is_near  whether a pixel of the picture shows the near thing
  // @param widened  px of the depth by which it is widened to the left; elsewhere by one
  template <class Near>
  Case(unsigned seed, const Near& is_near, int widened) {
    auto random = test::random_case(seed);
    std::normal_distribution<double> grain(0, 8), noise(0, 1);
    for (int y = 0; y < picture.height(); ++y) {
      const double streak = grain(random);  // of wood, along the rows
      for (int x = 0; x < picture.width(); ++x) {
        const bool near = is_near(x, y);
        if (near && x < truth.width()) truth(x, y) = 255;
        const Rgb base = near ? kSkin : kWood;
        const double add = (near ? 0 : streak) + noise(random);
        const auto level = [add](std::uint8_t v) { return static_cast<std::uint8_t>(v + add); };
        picture(x, y) = {level(base.r), level(base.g), level(base.b)};
      }
    }
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        for (int v = y - 1; v <= y + 1; ++v) {
          for (int u = x - 1; u <= x + widened; ++u) {
            if (is_near(2 * u, 2 * v)) at(x, y) = kHand;
          }
        }
      }
    }
  }
  float& at(int x, int y) { return depth[y * kWidth + x]; }

  // The number of picture pixels of the inner box on the wrong side.
  [[nodiscard]] int wrong(std::span<const float> fine) const {
    int count = 0;
    const int stride = 2 * inner.width;
    for (int y = 0; y < 2 * inner.height; ++y) {
      for (int x = 0; x < stride; ++x) {
        const float z = fine[y * stride + x];
        const bool near = z > 0 && z < kBody;
        count += near != (truth(2 * inner.x + x, 2 * inner.y + y) != 0) ? 1 : 0;
      }
    }
    return count;
  }
  [[nodiscard]] int wrong_without() const {
    std::vector<float> fine;
    for (int y = 2 * inner.y; y < 2 * inner.bottom(); ++y) {
      for (int x = 2 * inner.x; x < 2 * inner.right(); ++x) {
        fine.push_back(depth[y / 2 * kWidth + x / 2]);
      }
    }
    return wrong(fine);
  }
};

OutlineView view_of(const Case& c) {
  return {.picture = c.picture,
          .box = c.box,
          .depth = c.depth,
          .guessed = c.guessed,
          .inner = c.inner,
          .body = c.body,
          .moving = &c.moving,
          .too_close = &c.too_close};
}

std::vector<float> found(const Case& c) {
  RealOutlines outlines;
  outlines.find(view_of(c));
  return {outlines.depth().begin(), outlines.depth().end()};
}

TEST_CASE("an outline that was widened comes back to where the colour changes",
          "[render][outlines]") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    INFO("seed " << seed);
    // A slanted edge with the thing to its right, or to its left.
    const bool from_right = seed % 2 == 0;
    const auto near = [&](int x, int y) { return (x + y / 3 > 2 * kWidth * 2 / 3) == from_right; };
    const Case c(seed, near, 4);
    const int before = c.wrong_without();
    const int after = c.wrong(found(c));
    INFO(before << " pixels were wrong, " << after << " are");
    CHECK(before >= 250);  // else there is nothing to correct
    CHECK(after <= test::tolerance(20, "an edge of 82 picture rows: a pixel in four of them"));
  }
}

TEST_CASE("a gap between two fingers opens where its depth was not known", "[render][outlines]") {
  const auto finger = [](int y) { return std::abs(y - 84) < 18 || std::abs(y - 132) < 18; };
  Case c(
      3, [&](int x, int y) { return x > 90 && finger(y); }, 3);
  // A gap of twelve picture rows between the fingers. In three rows of the depth nothing is known;
  // the rows beside them have the fingers' depth.
  for (int y = 51; y <= 57; ++y) {
    for (int x = 45; x < kWidth; ++x) {
      c.at(x, y) = kHand;
      if (y >= 53 && y <= 55) c.guessed[y * kWidth + x] = 3;
    }
  }
  const int before = c.wrong_without();
  const int after = c.wrong(found(c));
  INFO(before << " pixels were wrong, " << after << " are");
  CHECK(before >= 1000);
  CHECK(after <= test::tolerance(150, "half a pixel along outlines of 300 picture pixels"));
}

// The share of the near thing's picture pixels within c.inner that are found before the body.
double near_share(const Case& c, const std::vector<float>& fine) {
  double near = 0, all = 0;
  const int stride = 2 * c.inner.width;
  for (int y = 0; y < 2 * c.inner.height; ++y) {
    for (int x = 0; x < stride; ++x) {
      if (c.truth(2 * c.inner.x + x, 2 * c.inner.y + y) == 0) continue;
      ++all;
      near += fine[y * stride + x] > 0 && fine[y * stride + x] < kBody ? 1 : 0;
    }
  }
  return near / all;
}

// A finger from the right that is so near that the matcher gives no depth for it, nor for a strip
// beside it.
Case near_finger() {
  Case c(
      11, [](int x, int y) { return x > 100 && std::abs(y - 104) < 30; }, 0);
  c.moving = MaskImage(kWidth, kHeight, 0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x > 50 && std::abs(y - 52) < 15) c.moving(x, y) = 255;
      if (x < 40 || std::abs(y - 52) > 18) continue;
      c.at(x, y) = 0;
      c.guessed[y * kWidth + x] = 127;
    }
  }
  return c;
}

TEST_CASE("moving pixels that are too near for any depth are before the body",
          "[render][outlines]") {
  Case c = near_finger();
  const std::vector<float> fine = found(c);
  CHECK(near_share(c, fine) >= 0.97);
  CHECK(c.wrong(fine) <= test::tolerance(220, "a picture pixel along an outline of 220"));
  // Without a moving mask, marks of the matcher in a fifth of the finger suffice; their edge is
  // found by the colours.
  c.moving = MaskImage();
  CHECK(near_share(c, found(c)) == 0);
  c.too_close = MaskImage(kWidth, kHeight, 0);
  auto random = test::random_case(2);
  for (int y = 38; y < 66; ++y) {
    for (int x = 52; x < kWidth; ++x) {
      if (random() % 5 == 0) c.too_close(x, y) = 255;
    }
  }
  CHECK(near_share(c, found(c)) >= 0.95);
}

TEST_CASE("a hole in a thing that moves behind the body hides nothing", "[render][outlines]") {
  Case c = near_finger();
  // All around the hole the depth of the hand is known: it is behind the body.
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      c.moving(x, y) = std::abs(y - 52) <= 22 ? 255 : 0;
      if (c.guessed[y * kWidth + x] != 0 && x > 90) {
        c.guessed[y * kWidth + x] = 0;
        c.at(x, y) = 0.45f;
      }
    }
  }
  const std::vector<float> fine = found(c);
  const int stride = 2 * c.inner.width;
  for (int y = 0; y < 2 * c.inner.height; ++y) {
    for (int x = 0; x < stride; ++x) {
      const float z = fine[y * stride + x];
      if (c.inner.x + x / 2 >= 68) REQUIRE_FALSE((z > 0 && z < kBody));
    }
  }
}

TEST_CASE("pixels of the other side's colour make no specks", "[render][outlines]") {
  // The hand's edge is vertical. In a strip around it the depth is not known, and some pixels have
  // the colour of the other side, like creases or grain.
  Case c(
      13, [](int x, int) { return x > 140; }, 0);
  auto random = test::random_case(13);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 60; x < 81; ++x) c.guessed[y * kWidth + x] = 3;
  }
  for (int y = 62; y < 2 * kHeight - 66; y += 6) {
    for (int x = 122; x < 160; x += 6) {
      if (random() % 2 != 0) continue;
      for (int k = 0; k < 4; ++k) c.picture(x + k % 2, y + k / 2) = x > 140 ? kWood : kSkin;
    }
  }
  const std::vector<float> fine = found(c);
  const int stride = 2 * c.inner.width;
  for (int y = 0; y < 2 * c.inner.height; ++y) {
    for (int x = 0; x < stride; ++x) {
      const int u = 2 * c.inner.x + x;
      if (std::abs(u - 140) <= 6) continue;  // a speck at the outline itself may join it
      INFO(u << " " << y);
      REQUIRE((fine[y * stride + x] < kBody) == (u > 140));
    }
  }
}

TEST_CASE("wrong depth beside an outline is corrected where the colours contradict it",
          "[render][outlines]") {
  // Two fingers; at the far end of the gap between them the depth is measured as that of the hand.
  const auto finger = [](int y) { return std::abs(y - 84) < 18 || std::abs(y - 132) < 18; };
  Case c(
      3, [&](int x, int y) { return x > 90 && finger(y); }, 0);
  for (int y = 51; y <= 57; ++y) {
    for (int x = 80; x < kWidth; ++x) c.at(x, y) = kHand;
  }
  const int before = c.wrong_without();
  const int after = c.wrong(found(c));
  INFO(before << " pixels were wrong, " << after << " are");
  CHECK(before >= 500);
  CHECK(after <= test::tolerance(200, "half a pixel along outlines of 300 picture pixels"));
}

TEST_CASE("where there are no jumps the depth is kept to the bit, whatever the colours",
          "[render][outlines][law]") {
  Case c(
      5, [](int, int) { return false; }, 0);
  auto random = test::random_case(5);
  for (Rgb& pixel : c.picture) pixel = {static_cast<std::uint8_t>(random() % 256), 10, 200};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) c.at(x, y) = 0.5f + 0.0002f * static_cast<float>(y);
  }
  c.at(60, 50) = 0;  // an unknown depth stays unknown
  c.guessed[50 * kWidth + 60] = 127;
  const std::vector<float> fine = found(c);
  const int stride = 2 * c.inner.width;
  for (int y = 0; y < 2 * c.inner.height; ++y) {
    for (int x = 0; x < stride; ++x) {
      const int u = c.inner.x + x / 2, v = c.inner.y + y / 2;
      if (std::abs(u - 60) <= 1 && std::abs(v - 50) <= 1) continue;  // within its median
      REQUIRE(fine[y * stride + x] == c.at(u, v));
    }
  }
}

TEST_CASE("far from every jump the depth is unchanged", "[render][outlines][law]") {
  Case c(
      7, [](int x, int) { return x > 150; }, 2);
  for (Rgb& pixel : c.picture) pixel = kWood;  // no differences in colour
  const std::vector<float> fine = found(c);
  const int stride = 2 * c.inner.width;
  for (int y = 0; y < 2 * c.inner.height; ++y) {
    for (int x = 0; x < stride; ++x) {
      const int u = c.inner.x + x / 2, v = c.inner.y + y / 2;
      if (u >= 72 && u <= 80) continue;
      REQUIRE(fine[y * stride + x] == c.at(u, v));
    }
  }
}

TEST_CASE("outlines take no memory once the sizes are known, and refuse sizes that do not fit",
          "[render][outlines][refusal]") {
  const Case c(
      9, [](int x, int y) { return x + y > 260; }, 4);
  RealOutlines outlines;
  const auto find = [&](const PixelBox& box, const PixelBox& inner) {
    OutlineView view = view_of(c);
    view.box = box;
    view.inner = inner;
    outlines.find(view);
  };
  find(c.box, c.inner);
  CHECK(test::allocations_during([&] { find(c.box, c.inner); }) == 0);
  CHECK(outlines.depth().size() == static_cast<std::size_t>(4 * c.inner.width * c.inner.height));
  find(c.box, {40, 40, 0, 0});
  CHECK(outlines.depth().empty());
  CHECK_THROWS_AS(find({0, 0, kWidth + 1, kHeight}, c.inner), ContractViolation);
  CHECK_THROWS_AS(find(c.box, {-1, 0, 5, 5}), ContractViolation);
  CHECK_THROWS_AS(find(c.box, PixelBox::between(20, 20, kWidth - 20, kHeight - 20)),
                  ContractViolation);  // body
  OutlineView view = view_of(c);
  view.depth = view.depth.first(50);
  CHECK_THROWS_AS(outlines.find(view), ContractViolation);
  const MaskImage small(10, 10, 0);
  for (const MaskImage* OutlineView::*mask : {&OutlineView::moving, &OutlineView::too_close}) {
    OutlineView wrong = view_of(c);
    wrong.*mask = &small;
    CHECK_THROWS_AS(outlines.find(wrong), ContractViolation);
  }
}

}  // namespace
}  // namespace palpable
