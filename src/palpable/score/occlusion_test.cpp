#include "palpable/score/occlusion.h"

#include "palpable/base/contract.h"
#include "tests/support/test.h"

#include <limits>

namespace palpable {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// A body over columns 1..4 of a 6 x 3 image at 0.5 m; a hand at 0.4 m over columns 0..2 of row 1;
// a wall at 1 m elsewhere, unknown in row 2.
struct Case {
  DepthImage body{6, 3, kNone};
  DepthImage truth{6, 3, 1.0f};
  MaskImage right{6, 3, 0};  // what should be drawn

  Case() {
    for (int y = 0; y < 3; ++y) {
      for (int x = 1; x <= 4; ++x) {
        body(x, y) = 0.5f;
        right(x, y) = 255;
      }
    }
    for (int x = 0; x <= 2; ++x) truth(x, 1) = 0.4f;
    for (int x = 0; x < 6; ++x) truth(x, 2) = kNone;
    right(1, 1) = right(2, 1) = 0;
  }
};

TEST_CASE("a body drawn exactly where it is seen has an overlap of 1", "[score]") {
  const Case c;
  const MaskOverlap overlap = compare_visible(c.right, c.body, c.truth);
  CHECK(overlap.body == 12);
  CHECK(overlap.hidden == 2);
  CHECK(overlap.both == 10);
  CHECK(overlap.either == 10);
  CHECK(overlap.iou() == 1.0);
}

TEST_CASE("a body that is drawn over the hand loses what the hand hides", "[score]") {
  Case c;
  c.right(1, 1) = c.right(2, 1) = 255;
  CHECK(compare_visible(c.right, c.body, c.truth).iou() == Approx(10.0 / 12.0));
}

TEST_CASE("a body that is missing where it should be seen loses that", "[score]") {
  Case c;
  for (int x = 0; x < 6; ++x) c.right(x, 0) = 0;
  CHECK(compare_visible(c.right, c.body, c.truth).iou() == Approx(6.0 / 10.0));
}

TEST_CASE("a mask of twice the size is counted in blocks of four", "[score]") {
  const Case c;
  MaskImage mask(12, 6, 0);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 12; ++x) mask(x, y) = c.right(x / 2, y / 2);
  }
  CHECK(compare_visible(mask, c.body, c.truth).iou() == 1.0);
  mask(2, 0) = mask(3, 0) = 0;  // half of a block is still enough
  CHECK(compare_visible(mask, c.body, c.truth).iou() == 1.0);
  mask(2, 1) = 0;
  CHECK(compare_visible(mask, c.body, c.truth).iou() == Approx(9.0 / 10.0));
}

TEST_CASE("no body in truth and picture is a perfect match", "[score]") {
  CHECK(compare_visible(MaskImage(2, 2), DepthImage(2, 2, kNone), DepthImage(2, 2, 1.0f)).iou() ==
        1.0);
}

TEST_CASE("images of other sizes are refused", "[score][errors]") {
  const Case c;
  CHECK_THROWS_AS(compare_visible(MaskImage(5, 3), c.body, c.truth), ContractViolation);
  CHECK_THROWS_AS(compare_visible(c.right, c.body, DepthImage(3, 6)), ContractViolation);
}

}  // namespace
}  // namespace palpable
