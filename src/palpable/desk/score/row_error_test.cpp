#include "palpable/desk/score/row_error.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cstdint>
#include <vector>

namespace palpable {
namespace {

// An offset of 0.1 px, and of 0.6 px from frame 3 on.
const std::vector<TrueRowOffset> kTruth{{0, 0.1}, {1, 0.1}, {2, 0.1}, {3, 0.6, true},
                                        {4, 0.6}, {5, 0.6}, {6, 0.6}};

TEST_CASE("after a step that is corrected in time, the remaining error counts", "[score]") {
  // With 2 frames to settle, frames 3, 4 and 5 do not count.
  const std::vector<RowCorrection> found{{0, 0.08}, {4, 0.3}, {6, 0.55}};
  CHECK(*largest_row_error(kTruth, found, 2) == Approx(0.05));
  CHECK(*largest_row_error(kTruth, found, 1) == Approx(0.3));  // frame 5 still has 0.3
}

TEST_CASE("a step that is never corrected is the error", "[score]") {
  CHECK(*largest_row_error(kTruth, std::vector<RowCorrection>{{0, 0.1}}, 2) == Approx(0.5));
}

TEST_CASE("a correction holds until the next, and is 0 before the first", "[score]") {
  CHECK(*largest_row_error(kTruth, std::vector<RowCorrection>{{3, 0.6}}, 0) == Approx(0.1));
}

TEST_CASE("too large a correction counts like too small a one", "[score]") {
  CHECK(*largest_row_error(kTruth, std::vector<RowCorrection>{{0, 0.4}, {3, 0.6}}, 2) ==
        Approx(0.3));
}

TEST_CASE("a frame that was not processed has no row error, but its step counts", "[score]") {
  const std::vector<RowCorrection> found{{0, 0.1}, {6, 0.6}};
  const std::vector<std::uint8_t> without_4_and_5{1, 1, 1, 1, 0, 0, 1};
  CHECK(*largest_row_error(kTruth, found, 0) == Approx(0.5));
  CHECK(*largest_row_error(kTruth, found, 0, without_4_and_5) == Approx(0.0));
  const std::vector<std::uint8_t> without_the_step{1, 1, 1, 0, 1, 1, 1};
  CHECK(*largest_row_error(kTruth, found, 2, without_the_step) == Approx(0.0));
  CHECK_THROWS_AS(largest_row_error(kTruth, {}, 0, std::vector<std::uint8_t>{1}),
                  ContractViolation);
}

TEST_CASE("where all frames are just after a step there is no error", "[score]") {
  CHECK_FALSE(
      largest_row_error(std::vector<TrueRowOffset>{{0, 3, true}, {1, 3}}, {}, 5).has_value());
  CHECK_FALSE(largest_row_error({}, {}, 0).has_value());
  CHECK_THROWS_AS(largest_row_error({}, {}, -1), ContractViolation);
}

}  // namespace
}  // namespace palpable
