#include "palpable/live/seen_object/color_outline.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace palpable {
namespace {

constexpr int kWidth = 120, kHeight = 90;
constexpr PixelBox kAll{0, 0, kWidth, kHeight};
constexpr PixelBox kThing{40, 30, 30, 40};
constexpr Rgb kSkin{190, 140, 120}, kDesk{230, 230, 225};

// A picture of twice the depth's size: a thing before a desk. The standard deviation of the pixels
// is `noise` grey levels on the thing and `texture` on the desk.
ColorImage picture_of(const PixelBox& thing, const Rgb& skin, double noise, double texture) {
  std::mt19937_64 random = test::random_case(1);
  std::normal_distribution<double> normal;
  ColorImage picture(2 * kWidth, 2 * kHeight);
  const auto noisy = [&](std::uint8_t level, double by) {
    return static_cast<std::uint8_t>(
        std::clamp(std::lround(level + by * normal(random)), 0L, 255L));
  };
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const bool is_thing = thing.contains(x / 2, y / 2);
      const Rgb c = is_thing ? skin : kDesk;
      const double by = is_thing ? noise : texture;
      picture(x, y) = {noisy(c.r, by), noisy(c.g, by), noisy(c.b, by)};
    }
  }
  return picture;
}

// A thing as a matcher's windows show it. @param too_wide  px by which it is too wide on each side
MaskImage shown(const PixelBox& thing, int too_wide) {
  MaskImage shows(kWidth, kHeight, kShowsRoom);
  for (int y = thing.y - too_wide; y < thing.y + thing.height + too_wide; ++y) {
    for (int x = thing.x - too_wide; x < thing.x + thing.width + too_wide; ++x) {
      shows(x, y) = kShowsPresser;
    }
  }
  return shows;
}

// Whether both masks are equal apart from the kind of room (kShowsRoom or kShowsRoomByColor).
bool show_alike(const MaskImage& a, const MaskImage& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](std::uint8_t x, std::uint8_t y) {
    return x == y || (shows_room(x) && shows_room(y));
  });
}

SeenFrame seen(ColorImage picture) {
  SeenFrame frame;
  frame.color = std::move(picture);
  return frame;
}

TEST_CASE("pixels beside a thing that have the desk's colour are given to the desk",
          "[seen_object][presses]") {
  ColorOutline outline;
  MaskImage shows = shown(kThing, 5);
  outline.trim(seen(picture_of(kThing, kSkin, 2, 2)), kAll, shows);
  CHECK(show_alike(shows, shown(kThing, 0)));
  // The room is marked as known by colour all along the outline, and nowhere else.
  constexpr PinholeCamera kPicture{kWidth, kHeight, 1, 1, 0, 0};
  const PixelBox around = grown(kThing, 1, kPicture), off = grown(kThing, 3, kPicture);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (shows(x, y) == kShowsPresser) continue;
      const bool beside = around.contains(x, y);
      if (beside || !off.contains(x, y)) CHECK((shows(x, y) == kShowsRoomByColor) == beside);
    }
  }
}

TEST_CASE("a finger's shaded rim is no desk, though the desk is as brown as it",
          "[seen_object][presses]") {
  // Skin in the shade, 0.76 times as bright, is nearer to the wood's colour than to the lit skin's.
  constexpr Rgb kLight{220, 177, 155}, kShaded{167, 135, 118}, kWood{173, 138, 105};
  ColorImage picture = picture_of(kThing, kLight, 2, 0);
  std::mt19937_64 random = test::random_case(2);
  std::normal_distribution<double> noise(0, 4);
  const auto noisy = [&](std::uint8_t level) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(level + noise(random)), 0L, 255L));
  };
  const PixelBox lit{kThing.x + 5, kThing.y + 5, kThing.width - 10, kThing.height - 10};
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (lit.contains(x / 2, y / 2)) continue;
      const Rgb c = kThing.contains(x / 2, y / 2) ? kShaded : kWood;
      picture(x, y) = {noisy(c.r), noisy(c.g), noisy(c.b)};
    }
  }
  ColorOutline outline;
  MaskImage shows = shown(kThing, 0);
  outline.trim(seen(picture), kAll, shows);
  int lost = 0;
  const MaskImage all = shown(kThing, 0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      lost += (shows(x, y) == kShowsPresser) != (all(x, y) == kShowsPresser);
    }
  }
  CHECK(lost <= 12);  // of 1,200: some of the outermost pixels, because of noise
}

TEST_CASE("the outline of the depth is kept where colours do not separate thing and room",
          "[seen_object][presses]") {
  ColorOutline outline;
  MaskImage shows = shown(kThing, 5);
  SECTION("thing and desk have the same colour") {
    outline.trim(seen(picture_of(kThing, {228, 226, 222}, 2, 2)), kAll, shows);
  }
  SECTION("the desk has many colours") {
    outline.trim(seen(picture_of(kThing, kSkin, 2, 90)), kAll, shows);
  }
  SECTION("there is no picture") { outline.trim(SeenFrame{}, kAll, shows); }
  SECTION("the band has no width") {
    ColorOutline({.band = 0}).trim(seen(picture_of(kThing, kSkin, 2, 2)), kAll, shows);
  }
  CHECK(shows == shown(kThing, 5));
  // Too thin to have an inside of which the colours could be known.
  constexpr PixelBox kThin{50, 20, 4, 50};
  shows = shown(kThin, 2);
  outline.trim(seen(picture_of(kThin, kSkin, 2, 2)), kAll, shows);
  CHECK(shows == shown(kThin, 2));
}

TEST_CASE(
    "outlines are corrected inside of the box only, and nothing is allocated from the second "
    "frame on",
    "[seen_object][presses][frame loop]") {
  ColorOutline outline;
  const SeenFrame frame = seen(picture_of(kThing, kSkin, 2, 2));
  MaskImage shows = shown(kThing, 5);
  outline.trim(frame, {0, 0, 55, kHeight}, shows);
  CHECK(shows_room(shows(37, 50)));
  CHECK(shows(73, 50) == kShowsPresser);
  shows = shown(kThing, 5);
  CHECK(test::allocations_during([&] { outline.trim(frame, kAll, shows); }) == 0);
  CHECK(shows_room(shows(73, 50)));
  CHECK_THROWS_AS(ColorOutline({.band = -1}), ContractViolation);
  CHECK_THROWS_AS(ColorOutline({.least_spread = 0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
