#include "palpable/live/seen_object/outline_search.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

namespace palpable {
namespace {

using test::tolerance;

constexpr int kWidth = 120, kHeight = 90;
constexpr PixelBox kAll{0, 0, kWidth, kHeight};
constexpr float kNear = 0.4F, kFar = 0.7F;  // m, of the thing and of the room
constexpr std::array<double, 3> kSkin{190, 140, 120}, kWood{170, 120, 75};

// A disc before a room; lengths in px of the depth image.
struct Disc {
  double x = 60.3, y = 44.6, radius = 20;
  [[nodiscard]] double inside(double u, double v) const {
    return radius - std::hypot(u - x, v - y);
  }
};

// What a camera sees of the disc, in a picture of twice the depth's size.
struct View {
  std::array<double, 3> skin = kSkin;
  double shade = 1;       // of the disc's light, what its outline has
  double texture = 3;     // grey levels, standard deviation
  double too_wide = 1.3;  // px by which the depth image has the disc too wide

  [[nodiscard]] SeenFrame seen(const Disc& disc) const {
    std::mt19937_64 random = test::random_case(1);
    std::normal_distribution<double> normal;
    SeenFrame frame;
    frame.color = ColorImage(2 * kWidth, 2 * kHeight);
    for (int v = 0; v < frame.color.height(); ++v) {
      for (int u = 0; u < frame.color.width(); ++u) {
        // Pixel u of the picture lies at (u - 1/2) / 2 of the depth image; its outline is blurred
        // over one pixel of the picture.
        const double in = disc.inside((u - 0.5) / 2, (v - 0.5) / 2);
        const double share = std::clamp(0.5 + 2 * in, 0.0, 1.0);
        const double light = 1 - (1 - shade) * std::clamp(1 - in / disc.radius, 0.0, 1.0);
        Rgb& pixel = frame.color(u, v);
        for (const auto& [level, c] : {std::pair{&pixel.r, 0}, {&pixel.g, 1}, {&pixel.b, 2}}) {
          const auto k = static_cast<std::size_t>(c);
          const double value = share * light * skin[k] + (1 - share) * kWood[k];
          *level = static_cast<std::uint8_t>(
              std::clamp(std::lround(value + texture * normal(random)), 0L, 255L));
        }
      }
    }
    frame.depth = DepthImage(kWidth, kHeight, kFar);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (disc.inside(x, y) > -too_wide) frame.depth(x, y) = kNear;
      }
    }
    return frame;
  }
};

MaskImage nearer(const SeenFrame& frame) {
  MaskImage shows(kWidth, kHeight, kShowsRoom);
  for (std::size_t i = 0; i < shows.size(); ++i) {
    if (frame.depth.data()[i] < 0.5F * (kNear + kFar)) shows.data()[i] = kShowsPresser;
  }
  return shows;
}

// px, the radius of the disc that has the area of the coverage.
double radius_of(const Image<float>& coverage) {
  double area = 0;
  for (const float share : coverage) area += static_cast<double>(share);
  return std::sqrt(area / std::numbers::pi);
}

TEST_CASE("an outline is found in the picture to 0.15 pixels, if the mask is 1 to 2.5 too wide",
          "[seen_object][presses]") {
  OutlineSearch search({.expected = -1.3});
  for (const double radius : {6.0, 12.4, 20.0}) {
    for (const double too_wide : {1.0, 1.3, 2.5}) {
      for (const double shade : {1.0, 0.7}) {
        CAPTURE(radius, too_wide, shade);
        const Disc disc{60.3, 44.6, radius};
        const SeenFrame frame = View{.shade = shade, .too_wide = too_wide}.seen(disc);
        MaskImage shows = nearer(frame);
        search.find(frame, kAll, shows);
        CHECK(radius_of(search.coverage()) ==
              Approx(radius).margin(tolerance(0.15, "px: noise of 3 grey levels, on a border")));
        // The mask holds what the thing covers by more than half.
        int wrong = 0;
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x) {
            const double in = disc.inside(x, y);
            if (std::abs(in) > 0.6) wrong += (shows(x, y) == kShowsPresser) != (in > 0);
          }
        }
        CHECK(wrong <= tolerance(static_cast<int>(0.05 * 2 * std::numbers::pi * radius),
                                 "5 % of the outline's pixels, by noise"));
      }
    }
  }
}

TEST_CASE("the room beside an outline that was found is marked, and none far from it",
          "[seen_object][presses]") {
  OutlineSearch search;
  const Disc disc;
  const SeenFrame frame = View{}.seen(disc);
  MaskImage shows = nearer(frame);
  search.find(frame, kAll, shows);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double in = disc.inside(x, y);
      CAPTURE(x, y);
      if (in < -7) CHECK(shows(x, y) == kShowsRoom);
      if (in > -1.4 && in < -0.6) CHECK(shows(x, y) == kShowsRoomByEdge);
      if (in > 5) CHECK(search.coverage()(x, y) == 1);
      if (in < -7) CHECK(search.coverage()(x, y) == 0);
    }
  }
}

TEST_CASE("an outline between equal colours stays as the depth has it", "[seen_object][presses]") {
  OutlineSearch search;
  const SeenFrame frame = View{.skin = kWood}.seen({});
  const MaskImage before = nearer(frame);
  MaskImage shows = before;
  search.find(frame, kAll, shows);
  CHECK(std::equal(shows.begin(), shows.end(), before.begin()));
  CHECK(std::count(search.coverage().begin(), search.coverage().end(), 1.0F) ==
        std::count(before.begin(), before.end(), kShowsPresser));
}

TEST_CASE("beside a nearer thing there is no outline to be found", "[seen_object][presses]") {
  OutlineSearch search;
  SeenFrame frame = View{}.seen({});
  const MaskImage before = nearer(frame);
  for (float& z : frame.depth) z = z > kNear ? 0.2F : z;  // the disc is seen through a hole
  MaskImage shows = before;
  search.find(frame, kAll, shows);
  CHECK(std::equal(shows.begin(), shows.end(), before.begin()));
}

TEST_CASE("a thing whose own outline is not found stays as it is beside one that is found",
          "[seen_object][presses]") {
  OutlineSearch search({.expected = -1.3});
  // Beside the disc, at its depth, lies a strip of the room's colour.
  const Disc disc{50, 44.6, 20};
  SeenFrame frame = View{}.seen(disc);
  constexpr int kStrip = 74;
  for (int y = 20; y < 70; ++y) {
    for (int x = kStrip; x < kStrip + 20; ++x) frame.depth(x, y) = kNear;
  }
  const MaskImage before = nearer(frame);
  MaskImage shows = before;
  search.find(frame, kAll, shows);
  int found = 0;
  for (int y = 30; y < 60; ++y) {
    for (int x = kStrip; x < kStrip + 20; ++x) {
      CAPTURE(x, y);
      CHECK(shows(x, y) == kShowsPresser);
      CHECK(search.coverage()(x, y) == 1);
    }
    found += shows(30, y) == kShowsRoomByEdge || shows(29, y) == kShowsRoomByEdge;
  }
  CHECK(found > 5);  // the disc's other side
}

TEST_CASE("holes in a thing are no outlines", "[seen_object][presses]") {
  OutlineSearch search({.expected = -1.3});
  const Disc disc;
  SeenFrame frame = View{}.seen(disc);
  // A print on the disc that has no depth, and single pixels without depth.
  for (int y = 40; y < 46; ++y) {
    for (int x = 56; x < 62; ++x) {
      frame.depth(x, y) = std::numeric_limits<float>::quiet_NaN();
      for (int v = 2 * y; v < 2 * y + 2; ++v) {
        for (int u = 2 * x; u < 2 * x + 2; ++u) frame.color(u, v) = {20, 20, 20};
      }
    }
  }
  std::mt19937_64 random = test::random_case(2);
  for (float& z : frame.depth) {
    if (random() % 10 == 0) z = std::numeric_limits<float>::quiet_NaN();
  }
  MaskImage before = nearer(frame);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (std::isnan(frame.depth.data()[i])) before.data()[i] = kShowsUnknown;
  }
  MaskImage shows = before;
  search.find(frame, kAll, shows);
  int changed = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (disc.inside(x, y) > 5) changed += shows(x, y) != before(x, y);
    }
  }
  CHECK(changed == 0);
}

TEST_CASE("outlines are found in a picture of the depth's size, and in a part of it",
          "[seen_object][presses]") {
  OutlineSearch search;
  const Disc disc;
  SeenFrame frame = View{.too_wide = 0.5}.seen(disc);
  ColorImage half(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) half(x, y) = frame.color(2 * x, 2 * y);
  }
  frame.color = half;
  MaskImage shows = nearer(frame);
  search.find(frame, {10, 5, 90, 80}, shows);
  double area = 0;
  for (int y = 5; y < 85; ++y) {
    for (int x = 10; x < 100; ++x) area += static_cast<double>(search.coverage()(x, y));
  }
  CHECK(std::sqrt(area / std::numbers::pi) ==
        Approx(disc.radius).margin(tolerance(0.3, "px: half the picture's pixels")));
  // The next box is found as if it were the first.
  OutlineSearch fresh;
  MaskImage again = nearer(frame), first = nearer(frame);
  search.find(frame, kAll, again);
  fresh.find(frame, kAll, first);
  CHECK(std::equal(again.begin(), again.end(), first.begin()));
  CHECK(std::equal(search.coverage().begin(), search.coverage().end(), fresh.coverage().begin()));
}

TEST_CASE("without a picture or a box nothing is searched", "[seen_object][presses]") {
  OutlineSearch search, off({.inside = 0});
  SeenFrame frame = View{}.seen({});
  const MaskImage before = nearer(frame);
  MaskImage shows = before;
  search.find(frame, {0, 0, 0, 0}, shows);
  off.find(frame, kAll, shows);
  frame.color = {};
  search.find(frame, kAll, shows);
  CHECK(std::equal(shows.begin(), shows.end(), before.begin()));
}

TEST_CASE("a search for outlines allocates nothing after the first frame", "[seen_object]") {
  OutlineSearch search;
  const SeenFrame frame = View{}.seen({});
  MaskImage nothing(kWidth, kHeight, kShowsRoom), disc = nearer(frame), stripes = nothing;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x / 2 % 2 == 0) stripes(x, y) = kShowsPresser;
    }
  }
  search.find(frame, kAll, nothing);
  CHECK(test::allocations_during([&] {
          search.find(frame, kAll, disc);
          search.find(frame, kAll, stripes);
        }) == 0);
}

TEST_CASE("a search for outlines refuses settings out of their range", "[seen_object]") {
  CHECK_THROWS_AS(OutlineSearch({.inside = 2}), ContractViolation);
  CHECK_THROWS_AS(OutlineSearch({.inside = 40}), ContractViolation);
  CHECK_THROWS_AS(OutlineSearch({.spread = 0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
