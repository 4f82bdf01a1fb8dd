#include "palpable/desk/score/mask_score.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>
#include <initializer_list>

namespace palpable {
namespace {

GrayImage row(std::initializer_list<std::uint8_t> values) {
  GrayImage image(static_cast<int>(values.size()), 1);
  std::copy(values.begin(), values.end(), image.begin());
  return image;
}

TEST_CASE("overlap, recall and false alarms of a small mask are those counted by hand", "[score]") {
  // 4 true pixels (bit 1), of which 3 are found, and 2 false ones
  const GrayImage truth = row({1, 3, 1, 1, 2, 0, 0, 2});
  const MaskImage found = row({255, 255, 1, 0, 255, 255, 0, 0});
  const MaskScore score = compare_masks(truth, 1, found);
  CHECK(score.pixels == 8);
  CHECK(*score.iou() == Approx(3.0 / 6.0));
  CHECK(*score.recall() == Approx(3.0 / 4.0));
  CHECK(*score.false_alarms() == Approx(2.0 / 8.0));
  CHECK(*compare_masks(truth, 2, found).recall() == Approx(2.0 / 3.0));
}

TEST_CASE("frames of a mask add up pixel by pixel", "[score]") {
  MaskScore sum = compare_masks(row({1, 1, 1, 1}), 1, row({255, 255, 255, 255}));
  sum += compare_masks(row({1, 1, 0, 0}), 1, row({0, 0, 0, 255}));
  CHECK(*sum.recall() == Approx(4.0 / 6.0));
  CHECK(*sum.iou() == Approx(4.0 / 7.0));
  CHECK(*sum.false_alarms() == Approx(1.0 / 8.0));
}

TEST_CASE("a frame without a mask misses all moving pixels and has no false alarm", "[score]") {
  MaskScore sum = missing_mask(row({1, 3, 0, 2, 0}), 1);
  CHECK(*sum.recall() == 0.0);
  CHECK_FALSE(sum.false_alarms().has_value());
  sum += compare_masks(row({1, 1, 0, 0}), 1, row({255, 0, 0, 255}));
  CHECK(*sum.recall() == Approx(1.0 / 4.0));
  CHECK(*sum.false_alarms() == Approx(1.0 / 4.0));
}

TEST_CASE("where nothing moves in truth there is no overlap and no recall", "[score]") {
  MaskScore nothing = compare_masks(row({0, 2}), 1, row({0, 0}));
  nothing += compare_masks(row({0, 2}), 1, row({0, 255}));
  CHECK(nothing.found == 1);
  CHECK_FALSE(nothing.iou().has_value());
  CHECK_FALSE(nothing.recall().has_value());
  CHECK(*nothing.false_alarms() == Approx(1.0 / 4.0));
  // Once something moves, the false pixels of earlier frames count, too.
  nothing += compare_masks(row({1, 2}), 1, row({255, 0}));
  CHECK(*nothing.iou() == Approx(1.0 / 2.0));
}

TEST_CASE("masks of other sizes are refused", "[score][errors]") {
  CHECK_THROWS_AS(compare_masks(GrayImage(4, 3), 1, MaskImage(3, 4)), ContractViolation);
}

}  // namespace
}  // namespace palpable
