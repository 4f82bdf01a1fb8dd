#include "palpable/live/sources/picture_rate.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("the measured rate is the camera's, whatever the reader misses", "[sources][camera]") {
  PictureRate rate;
  for (int i = 0; i < 8; ++i) rate.add(5 + i / 15.0, i);  // 0.5 s, not counted
  CHECK_FALSE(rate.rate());
  for (int i = 8; i < 23; ++i) rate.add(5 + i / 15.0, i);
  CHECK_FALSE(rate.rate());  // 14 intervals
  rate.add(5 + 23 / 15.0, 23);
  REQUIRE(rate.rate());
  CHECK(*rate.rate() == Approx(15));

  // Every third picture is read, and there is a pause of 2 s.
  rate.restart();
  CHECK_FALSE(rate.rate());
  for (int i = 0; i < 120; i += 3) rate.add(i / 30.0 + (i > 40 ? 2 : 0), i);
  CHECK(rate.rate().value() == Approx(30));

  // Long exposures while the automatic one settles.
  rate.restart();
  for (int i = 0; i < 8; ++i) rate.add(i / 16.0, i);
  for (int i = 0; i < 30; ++i) rate.add(0.5 + i / 30.0, 8 + i);
  CHECK(rate.rate().value() == Approx(30));
}

TEST_CASE("half the rate is far below, a fifth less is not", "[sources][camera]") {
  CHECK(is_far_below(15, 30));
  CHECK(is_far_below(20, 30));
  CHECK_FALSE(is_far_below(25, 30));
  CHECK_FALSE(is_far_below(29.97, 30));
  CHECK_FALSE(is_far_below(60, 30));
}

}  // namespace
}  // namespace palpable
