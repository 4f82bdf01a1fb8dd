#include "palpable/common/response/held_out_touch.h"

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

}  // namespace
}  // namespace palpable
