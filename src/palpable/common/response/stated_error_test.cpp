#include "palpable/common/response/stated_error.h"

#include "palpable/common/response/held_out_touch.h"
#include "tests/support/test.h"

#include <vector>

namespace palpable {
namespace {

HeldOutTouch touch_of(double displacement, double stress, std::optional<double> indicated) {
  return {PressingThing::kFinger, 0.004, displacement, 0.01, stress, indicated};
}

TEST_CASE("the stated error is the true one of the median held-out touch, and some more",
          "[response]") {
  std::vector<HeldOutTouch> touches;
  for (int k = 1; k <= 9; ++k) touches.push_back(touch_of(0.01 * k, 0.1 * k, 0.02));
  touches.push_back(touch_of(100, 100, std::nullopt));  // without indicators
  touches.push_back(touch_of(100, 100, 0.0));
  const ErrorScale scale = error_scale(touches).value();
  CHECK(scale.displacement == Approx(kOnTheSafeSide * 2.5));
  CHECK(scale.von_mises == Approx(kOnTheSafeSide * 25));
  // Indicators with the same sum as those of the touches.
  const double per_entry = unscaled_error({.entry = 1});
  const StatedError stated = scale.stated({.entry = 0.02 / per_entry});
  CHECK(stated.displacement == Approx(kOnTheSafeSide * 0.05));
  CHECK(stated.von_mises == Approx(kOnTheSafeSide * 0.5));
}

TEST_CASE("too few touches calibrate nothing", "[response]") {
  std::vector<HeldOutTouch> touches(kLeastTouches, touch_of(0.01, 0.1, 0.02));
  CHECK(error_scale(touches).has_value());
  touches.back().unscaled_error.reset();
  CHECK_FALSE(error_scale(touches).has_value());
  CHECK_FALSE(error_scale({}).has_value());
}

TEST_CASE("every indicator adds to the stated error", "[response]") {
  CHECK(unscaled_error({}) == 0.0);
  const double all = unscaled_error({.entry = 0.01, .beyond = 0.02, .cross = 0.03});
  CHECK(all > unscaled_error({.entry = 0.0, .beyond = 0.02, .cross = 0.03}));
  CHECK(all > unscaled_error({.entry = 0.01, .beyond = 0.0, .cross = 0.03}));
  CHECK(all > unscaled_error({.entry = 0.01, .beyond = 0.02, .cross = 0.0}));
}

}  // namespace
}  // namespace palpable
