#include "palpable/desk/score/touch_false.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <limits>
#include <vector>

namespace palpable {
namespace {

using Flags = std::vector<std::uint8_t>;
using Gaps = std::vector<std::optional<double>>;

TEST_CASE("false touches are the share of felt frames in which nothing is near", "[score]") {
  const double no_hand = std::numeric_limits<double>::infinity();
  const Gaps gaps{no_hand, 0.006, 0.005, 0.0, 0.2};
  CHECK(*touch_false(gaps, Flags{0, 0, 1, 1, 0}) == 0);
  CHECK(*touch_false(gaps, Flags{1, 1, 1, 1, 0}) == 0.5);
  CHECK(*touch_false(gaps, Flags{0, 0, 0, 0, 1}) == 1);
  CHECK_FALSE(touch_false(gaps, Flags{0, 0, 0, 0, 0}).has_value());
}

TEST_CASE("an unknown gap matters only in frames with a felt touch", "[score]") {
  const Gaps gaps{std::nullopt, 0.1};
  CHECK(*touch_false(gaps, Flags{0, 1}) == 1);
  CHECK_FALSE(touch_false(gaps, Flags{1, 1}).has_value());
}

TEST_CASE("lists of two lengths are refused by the share of false touches", "[score][errors]") {
  CHECK_THROWS_AS(touch_false(Gaps(2), Flags{0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
