#include "palpable/desk/score/touch_recall.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <vector>

namespace palpable {
namespace {

using Flags = std::vector<std::uint8_t>;

TEST_CASE("recall is the share that is felt of the touches that are deep and seen", "[score]") {
  //                                  at rest   shallow     deep      deep       deep
  const std::vector<TrueReach> truth{{0, 1}, {0.003, 1}, {0.0031, 1}, {0.01, 0.5}, {0.004, 1}};
  CHECK(*touch_recall(truth, Flags{0, 0, 1, 1, 1}) == 1);
  CHECK(*touch_recall(truth, Flags{1, 1, 0, 1, 0}) == Approx(1.0 / 3));
  CHECK(*touch_recall(truth, Flags{1, 1, 0, 0, 0}) == 0);
}

TEST_CASE("a touch that no camera sees does not count as missed", "[score]") {
  const std::vector<TrueReach> truth{{0.008, 0.49}, {0.008, 0}, {0.008, 0.9}};
  CHECK(*touch_recall(truth, Flags{0, 0, 1}) == 1);
  CHECK_FALSE(touch_recall(std::span(truth).first(2), Flags{0, 1}).has_value());
}

TEST_CASE("lists of two lengths are refused by the recall", "[score][errors]") {
  CHECK_THROWS_AS(touch_recall(std::vector<TrueReach>(2), Flags{0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
