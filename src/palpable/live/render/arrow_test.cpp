#include "palpable/live/render/arrow.h"

#include "tests/support/test.h"

#include <limits>

namespace palpable {
namespace {

constexpr Rgb kPaper{200, 200, 200}, kRed{220, 30, 30};

TEST_CASE("an arrow covers shaft and head, and nothing beyond its ends", "[render][arrow]") {
  ColorImage picture(100, 60, kPaper);
  draw_arrow(picture, {20, 30}, {80, 30}, 4, kRed);
  CHECK(picture(40, 30) == kRed);
  CHECK(picture(70, 33) == kRed);    // the head is wider than the shaft
  CHECK(picture(40, 36) == kPaper);  // beside the shaft
  CHECK(picture(84, 30) == kPaper);
  CHECK(picture(15, 30) == kPaper);
  // The head ends in a point.
  CHECK_FALSE(picture(78, 30) == kPaper);
  CHECK(picture(78, 36) == kPaper);
}

TEST_CASE("an arrow is cut off where the picture ends, and needs two ends", "[render][arrow]") {
  ColorImage picture(40, 40, kPaper);
  draw_arrow(picture, {-30, 20}, {20, 20}, 4, kRed);
  CHECK(picture(0, 20) == kRed);
  const ColorImage before = picture;
  draw_arrow(picture, {std::numeric_limits<float>::quiet_NaN(), 0}, {20, 5}, 4, kRed);
  draw_arrow(picture, {-300, -100}, {-200, -100}, 4, kRed);
  CHECK(picture == before);
}

TEST_CASE("an arrow shorter than its head is all head", "[render][arrow]") {
  ColorImage picture(40, 40, kPaper);
  draw_arrow(picture, {18, 20}, {22, 20}, 4, kRed);
  CHECK(picture(19, 23) == kRed);
  CHECK(picture(26, 20) == kPaper);
  CHECK(picture(12, 20) == kPaper);
}

}  // namespace
}  // namespace palpable
