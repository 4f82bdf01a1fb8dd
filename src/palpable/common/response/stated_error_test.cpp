#include "palpable/common/response/stated_error.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Touches = std::vector<HeldOutTouch>;

const Touches kThree{{PressingThing::kFinger, 0.002, 0.01, 0.002, 0.04},
                     {PressingThing::kRim, 0.0061, 0.03, 0.004, 0.20},
                     {PressingThing::kFinger, 0.004, 0.02, 0.009, 0.08}};

TEST_CASE("the text of held-out touches has their obstacles, depths and errors", "[response]") {
  CHECK(held_out_text({}).empty());
  CHECK(held_out_text(kThree) ==
        "3 touches (2 finger, 1 rim; 2.0 to 6.1 mm deep) against full finite elements: "
        "displacement 2.0 % off (median; worst 3 %), force 0.4 % (1 %), stress 8.0 % (20 %)");
  const TouchErrors stress = errors_of(kThree, &HeldOutTouch::von_mises);
  CHECK(stress.median == 0.08);
  CHECK(stress.worst == 0.20);
  CHECK_THROWS_AS(errors_of({}, &HeldOutTouch::force), ContractViolation);
  CHECK(name_of(PressingThing::kSqueeze) == "squeeze");
}

TEST_CASE("an invalid held-out touch is named", "[response]") {
  CHECK(trouble_of(kThree).empty());
  const auto spoilt = [](auto change) {
    Touches touches = kThree;
    change(touches[1]);
    return trouble_of(touches);
  };
  CHECK(spoilt([](auto& t) { t.thing = static_cast<PressingThing>(kPressingThings); }) ==
        "an obstacle");
  CHECK(spoilt([](auto& t) { t.thing = static_cast<PressingThing>(-1); }) == "an obstacle");
  CHECK(spoilt([](auto& t) { t.depth = 0; }) == "a depth");
  CHECK(spoilt([](auto& t) { t.unscaled_error = NAN; }) == "the error indicators of a touch");
  CHECK(spoilt([](auto& t) { t.unscaled_error = -0.1; }) == "the error indicators of a touch");
  for (const auto& named : kHeldOutDifferences) {
    INFO(named.first);
    const auto difference = named.second;
    CHECK(spoilt([&](auto& t) { t.*difference = NAN; }) == "a difference");
    CHECK(spoilt([&](auto& t) { t.*difference = -0.01; }) == "a difference");
  }
}

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
