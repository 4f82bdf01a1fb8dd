#include "palpable/desk/score/picture_scores.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

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

  [[nodiscard]] MaskOverlap overlap(const MaskImage& drawn) const {
    return overlap_of(true_sight(body, truth), drawn_sight(drawn, body));
  }
};

TEST_CASE("a body drawn exactly where it is seen has an overlap of 1", "[score]") {
  const Case c;
  const MaskOverlap overlap = c.overlap(c.right);
  CHECK(overlap.body == 12);
  CHECK(overlap.hidden == 2);
  CHECK(overlap.both == 10);
  CHECK(overlap.either == 10);
  CHECK(overlap.iou() == 1.0);
}

TEST_CASE("drawing the body over the hand lowers the overlap", "[score]") {
  Case c;
  c.right(1, 1) = c.right(2, 1) = 255;
  CHECK(c.overlap(c.right).iou() == Approx(10.0 / 12.0));
}

TEST_CASE("a part of the body that should be visible and is missing lowers the overlap",
          "[score]") {
  Case c;
  for (int x = 0; x < 6; ++x) c.right(x, 0) = 0;
  CHECK(c.overlap(c.right).iou() == Approx(6.0 / 10.0));
}

TEST_CASE("drawing where there is no body lowers the overlap", "[score]") {
  Case c;
  c.right(0, 0) = 255;
  CHECK(c.overlap(c.right).iou() == Approx(10.0 / 11.0));
}

TEST_CASE("a mask of twice the size is counted in blocks of four", "[score]") {
  const Case c;
  MaskImage mask(12, 6, 0);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 12; ++x) mask(x, y) = c.right(x / 2, y / 2);
  }
  CHECK(c.overlap(mask).iou() == 1.0);
  mask(2, 0) = mask(3, 0) = 0;  // two of four pixels are enough
  CHECK(c.overlap(mask).iou() == 1.0);
  mask(2, 1) = 0;
  CHECK(c.overlap(mask).iou() == Approx(9.0 / 10.0));
}

TEST_CASE("no body in truth and picture is a perfect match", "[score]") {
  const DepthImage none(2, 2, kNone);
  CHECK(overlap_of(true_sight(none, DepthImage(2, 2, 1.0f)), drawn_sight(MaskImage(2, 2), none))
            .iou() == 1.0);
}

// An image from rows of text: '.' no body, '#' visible, 'o' hidden.
SightImage drawing(const std::vector<std::string>& rows) {
  SightImage image(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const char c = rows[y][x];
      image(x, y) = c == '#' ? Sight::kVisible : c == 'o' ? Sight::kHidden : Sight::kNoBody;
    }
  }
  return image;
}

TEST_CASE("a straight border drawn 3 px too far has an error of 3 px", "[score]") {
  const SightImage truth = drawing({"..ooo#####..", "..ooo#####..", "..ooo#####.."});
  const SightImage drawn = drawing({"..oooooo##..", "..oooooo##..", "..oooooo##.."});
  const BorderError error = border_error(truth, drawn);
  CHECK(error.pixels == 6);
  CHECK(*error.mean_px() == Approx(3));
  CHECK(*border_error(truth, truth).mean_px() == 0);
}

TEST_CASE("a border's distance is to the nearest pixel of the other, in any direction", "[score]") {
  const SightImage truth =
      drawing({"#o..........", "............", "............", "............"});
  const SightImage drawn =
      drawing({"............", "............", "............", "....#o......"});
  CHECK(*border_error(truth, drawn).mean_px() == Approx(5));
}

TEST_CASE("the body's own outline is no border", "[score]") {
  const SightImage all = drawing({"....", ".##.", "...."});
  CHECK_FALSE(border_error(all, all).mean_px().has_value());
}

TEST_CASE("a border that was not drawn at all counts the largest error", "[score]") {
  const SightImage truth = drawing({"..ooo#####..", "..ooo#####.."});
  const SightImage drawn = drawing({"..########..", "..########.."});
  CHECK(border_error(truth, drawn).pixels == 2);
  CHECK(*border_error(truth, drawn).mean_px() == kLargestBorderError);
}

// A mask from rows of text: '1' where something moves.
MaskImage moving(const std::vector<std::string>& rows) {
  MaskImage image(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) { image(x, y) = rows[y][x] == '1' ? 255 : 0; }
  }
  return image;
}

TEST_CASE("a hand crosses the outline if it continues beside the body", "[score]") {
  const SightImage truth = drawing({".####.", ".oo##.", ".####."});
  CHECK(crosses_outline(truth, moving({"000000", "111000", "000000"})));
  // A hand in front of the middle of the body only.
  CHECK_FALSE(crosses_outline(truth, moving({"000000", "011000", "000000"})));
  // A static thing hides the body, and a hand is beside it.
  CHECK_FALSE(crosses_outline(truth, moving({"000000", "100000", "000000"})));
  CHECK_FALSE(crosses_outline(truth, moving({"000000", "000000", "000000"})));
  // Without a mask everything that hides the body counts.
  CHECK(crosses_outline(truth, {}));
}

TEST_CASE("a hand that hides all of the body, or passes behind it, does not cross", "[score]") {
  const MaskImage hand = moving({"1111", "1111"});
  CHECK_FALSE(crosses_outline(drawing({".oo.", ".oo."}), hand));
  CHECK_FALSE(crosses_outline(drawing({".##.", ".##."}), hand));
  CHECK(crosses_outline(drawing({".o#.", ".oo."}), hand));
  CHECK_THROWS_AS(crosses_outline(SightImage(2, 3), MaskImage(3, 2)), ContractViolation);
}

TEST_CASE("flicker counts what changes in the picture and not in the truth", "[score]") {
  const SightImage truth_before = drawing({"###ooo...#"});
  const SightImage drawn_before = drawing({"###ooo...#"});
  const SightImage truth = drawing({"##oooo#..."});
  const SightImage drawn = drawing({"#ooo#o#..."});
  // The truth is the same in columns 0, 1, 3, 4 and 5. The picture changes in column 1 (# to o) and
  // column 4 (o to #).
  const Flicker flicker = flicker_between(truth_before, drawn_before, truth, drawn);
  CHECK(flicker.pixels == 5);
  CHECK(flicker.changed == 2);
  CHECK(*flicker.share() == Approx(0.4));
}

TEST_CASE("a picture that is wrong in the same way twice does not flicker", "[score]") {
  const SightImage truth = drawing({"####ooo"});
  const SightImage drawn = drawing({"##ooooo"});
  CHECK(*flicker_between(truth, drawn, truth, drawn).share() == 0);
  const SightImage none = drawing({"......."});
  CHECK_FALSE(flicker_between(none, none, none, none).share().has_value());
}

TEST_CASE("images of other sizes are refused", "[score][errors]") {
  const Case c;
  CHECK_THROWS_AS(drawn_sight(MaskImage(5, 3), c.body), ContractViolation);
  CHECK_THROWS_AS(true_sight(c.body, DepthImage(3, 6)), ContractViolation);
  CHECK_THROWS_AS(overlap_of(SightImage(2, 3), SightImage(3, 2)), ContractViolation);
  CHECK_THROWS_AS(border_error(SightImage(2, 3), SightImage(3, 2)), ContractViolation);
  const SightImage a(2, 3);
  CHECK_THROWS_AS(flicker_between(a, a, a, SightImage(3, 2)), ContractViolation);
}

}  // namespace
}  // namespace palpable
