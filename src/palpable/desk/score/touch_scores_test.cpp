#include "palpable/desk/score/touch_scores.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <limits>
#include <vector>

namespace palpable {
namespace {

using Flags = std::vector<std::uint8_t>;
using Gaps = std::vector<std::optional<double>>;

TEST_CASE("delay, precision and recall of a small run are those counted by hand", "[score]") {
  //                 0  1  2  3  4  5  6  7  8  9
  const Flags truth{0, 0, 1, 1, 1, 1, 1, 0, 0, 0};
  const Flags found{0, 0, 0, 0, 1, 1, 1, 1, 0, 0};
  const TouchScore score = score_touches(truth, found);
  CHECK(score.frames == 10);
  CHECK(score.truly_touching == 5);
  CHECK(score.found_touching == 4);
  CHECK(score.both == 3);
  CHECK(score.first_touch_delay_frames == 2);
  CHECK(*score.precision == 0.75);
  CHECK(*score.recall == 0.6);
}

TEST_CASE("a touch that is felt too early has a negative delay", "[score]") {
  CHECK(score_touches(Flags{0, 0, 0, 1}, Flags{1, 0, 0, 1}).first_touch_delay_frames == -3);
}

TEST_CASE("without a touch there is no delay and no share", "[score]") {
  const TouchScore never_found = score_touches(Flags{0, 1}, Flags{0, 0});
  CHECK_FALSE(never_found.first_touch_delay_frames.has_value());
  CHECK_FALSE(never_found.precision.has_value());
  CHECK(*never_found.recall == 0);
  const TouchScore never_true = score_touches(Flags{0, 0}, Flags{0, 1});
  CHECK_FALSE(never_true.first_touch_delay_frames.has_value());
  CHECK(*never_true.precision == 0);
  CHECK_FALSE(never_true.recall.has_value());
}

TEST_CASE("sites are compared where truth and result both have one", "[score]") {
  const std::vector<int> truth{-1, 3, 3, 3, 5, -1, 2};
  const std::vector<int> found{3, 3, 4, 3, -1, 2, 3};
  // Frames 1, 2, 3 and 6 are compared; 1 and 3 are equal.
  CHECK(*score_sites(truth, found) == Approx(0.5));
  CHECK_FALSE(score_sites(std::vector{-1, 2}, std::vector{2, -1}).has_value());
}

TEST_CASE("lists of different lengths are refused", "[score][errors]") {
  CHECK_THROWS_AS(score_touches(Flags{0, 1}, Flags{0}), ContractViolation);
  CHECK_THROWS_AS(score_sites(std::vector{0, 1}, std::vector{0}), ContractViolation);
}

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
