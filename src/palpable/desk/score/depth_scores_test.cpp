#include "palpable/desk/score/depth_scores.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>

namespace palpable {
namespace {

using test::tolerance;

constexpr double kMillimetre = 1e-3;  // m per count, so that counts are mm
constexpr MaskImage kNone{};

// 7 x 1 pixels.
DepthCounts row(std::array<std::uint16_t, 7> counts) {
  DepthCounts image(7, 1);
  std::copy(counts.begin(), counts.end(), image.begin());
  return image;
}
MaskImage labels_of(std::array<std::uint8_t, 7> labels) {
  MaskImage image(7, 1);
  std::copy(labels.begin(), labels.end(), image.begin());
  return image;
}

TEST_CASE("median error and share within 1 % are those that one counts by hand", "[score]") {
  DepthScorer scorer(kMillimetre);
  // At 0.2 m: right, 0.5 % off, 1 % off, 2 % off, no depth, too close. The last pixel belongs to no
  // distance class.
  scorer.add(row({200, 200, 200, 200, 200, 200, 400}), kNone,
             row({200, 201, 198, 204, kNoDepth, kTooClose, 400}));
  const DepthAtDistance at = scorer.score().at[0];
  CHECK(at.pixels == 6);
  CHECK(at.measured == 4);
  CHECK(at.within == 3);
  CHECK(*at.median_error == Approx(0.0075));
  CHECK(*at.within_1pct == Approx(0.5));
  CHECK(*at.density == Approx(4.0 / 6.0));
  for (std::size_t k = 1; k < kDepthDistances.size(); ++k) {
    CHECK(scorer.score().at[k].pixels == 0);
    CHECK_FALSE(scorer.score().at[k].median_error.has_value());
    CHECK_FALSE(scorer.score().at[k].within_1pct.has_value());
  }
}

TEST_CASE("1 % of the true depth is within, and a ten-thousandth more is not", "[score]") {
  DepthScorer scorer(kMillimetre);
  scorer.add(row({10000, 10000, 10000, 10000, 0, 0, 0}), kNone,
             row({10100, 10101, 9900, 9899, 0, 0, 0}));
  CHECK(scorer.score().at[6].within == 2);
}

TEST_CASE("a distance holds what lies within 15 % of it", "[score]") {
  DepthScorer scorer(kMillimetre);
  const auto image = row({169, 170, 230, 231, 254, 255, 345});
  scorer.add(image, kNone, image);
  CHECK(scorer.score().at[0].pixels == 2);
  CHECK(scorer.score().at[1].pixels == 2);
}

TEST_CASE("frames add up, and an even number of errors has the mean of the middle two", "[score]") {
  DepthScorer scorer(kMillimetre);
  scorer.add(row({1000, 1000, 0, 0, 0, 0, 0}), kNone, row({1010, 1020, 7, 7, 7, 7, 7}));
  scorer.add(row({1000, 1000, 0, 0, 0, 0, 0}), kNone, row({1030, 5000, 7, 7, 7, 7, 7}));
  const DepthAtDistance at = scorer.score().at[3];
  CHECK(at.pixels == 4);
  CHECK(*at.median_error == Approx(0.025));
  CHECK(at.within == 1);
}

TEST_CASE("pixels that the right eye does not see are not scored", "[score]") {
  DepthScorer scorer(kMillimetre);
  scorer.add(row({500, 500, 500, 500, 0, 0, 0}), labels_of({2, 2, 0, 1, 2, 2, 2}),
             row({500, 0, 0, 0, 0, 0, 0}));
  CHECK(scorer.score().at[2].pixels == 2);
  CHECK(*scorer.score().at[2].within_1pct == 0.5);
}

TEST_CASE("a near hand's share is over its pixels that both eyes see", "[score]") {
  DepthScorer scorer(kMillimetre);
  // A near hand: right, 3 % off, no depth, and one pixel that the right eye does not see; then
  // desk.
  scorer.add(row({300, 300, 310, 290, 800, 800, 800}), labels_of({3, 3, 3, 1, 2, 2, 2}),
             row({300, 309, 0, 0, 1, 1, 1}));
  CHECK(*scorer.score().hand_within_1pct == Approx(1.0 / 3.0));
  CHECK(scorer.score().near_frames == 1);
  // A frame does not count as near if the hand is far or its median depth is too small.
  scorer.add(row({600, 600, 600, 600, 800, 800, 800}), labels_of({3, 3, 3, 3, 2, 2, 2}),
             row({1, 1, 1, 1, 1, 1, 1}));
  scorer.add(row({110, 110, 110, 130, 800, 800, 800}), labels_of({3, 3, 3, 3, 2, 2, 2}),
             row({1, 1, 1, 1, 1, 1, 1}));
  CHECK(scorer.score().near_frames == 1);
  CHECK(*scorer.score().hand_within_1pct == Approx(1.0 / 3.0));
}

TEST_CASE("a hand that covers less than 5 % of the image is no near hand", "[score]") {
  const auto with_hand = [](int pixels) {
    DepthScorer scorer(kMillimetre);
    const DepthCounts depth(20, 5, 300);
    MaskImage labels(20, 5, kBothSeeLabel);
    for (int i = 0; i < pixels; ++i) labels.data()[i] |= kMovesLabel;
    scorer.add(depth, labels, depth);
    return scorer.score();
  };
  CHECK(with_hand(4).near_frames == 0);
  CHECK_FALSE(with_hand(4).hand_within_1pct.has_value());
  CHECK(with_hand(5).near_frames == 1);
  CHECK(*with_hand(5).hand_within_1pct == 1);
  CHECK(with_hand(0).near_frames == 0);
}

TEST_CASE("a pixel that is too close may be unknown or marked too close, but not be far",
          "[score]") {
  DepthScorer scorer(kMillimetre);
  // At 100 mm: right, 20 % more, 21 % more, far, unknown, too close. 110 mm is not too close.
  scorer.add(row({100, 100, 100, 100, 100, 100, 110}), kNone,
             row({100, 120, 121, 900, kNoDepth, kTooClose, 900}));
  CHECK(scorer.score().too_close_pixels == 6);
  CHECK(*scorer.score().too_close_called_far == Approx(2.0 / 6.0));
  DepthScorer nothing(kMillimetre);
  nothing.add(row({110, 200, 0, 0, 0, 0, 0}), kNone, row({900, 900, 900, 900, 900, 900, 900}));
  CHECK_FALSE(nothing.score().too_close_called_far.has_value());
}

TEST_CASE("errors larger than the depth itself count as the whole depth", "[score]") {
  DepthScorer scorer(kMillimetre);
  scorer.add(row({200, 0, 0, 0, 0, 0, 0}), kNone, row({9000, 0, 0, 0, 0, 0, 0}));
  CHECK(*scorer.score().at[0].median_error == 1);
}

TEST_CASE("counts are converted by the unit", "[score]") {
  DepthScorer scorer(0.00025);
  scorer.add(row({60000, 800, 0, 0, 0, 0, 0}), kNone, row({60300, 800, 0, 0, 0, 0, 0}));
  CHECK(scorer.score().at[0].pixels == 1);  // 0.2 m
  CHECK(scorer.score().at[7].pixels == 1);  // 15 m
  CHECK(std::abs(*scorer.score().at[7].median_error - 0.005) <=
        tolerance(5e-6, "half a step of the histogram"));
}

TEST_CASE("depths of other sizes are refused", "[score][errors]") {
  DepthScorer scorer(kMillimetre);
  CHECK_THROWS_AS(scorer.add(DepthCounts(7, 1), kNone, DepthCounts(1, 7)), ContractViolation);
  CHECK_THROWS_AS(scorer.add(DepthCounts(7, 1), MaskImage(6, 1), DepthCounts(7, 1)),
                  ContractViolation);
  CHECK_THROWS_AS(DepthScorer(0), ContractViolation);
}

const PinholeCamera kCamera{64, 48, 50, 50, 31.5, 23.5};

// Six images of a wall at Z = 1 m in the world; the camera moves 2 mm towards it per image.
struct Walk {
  std::vector<DepthImage> depths;
  std::vector<Rigid3> poses;

  Walk() {
    for (int n = 0; n < 6; ++n) {
      DepthImage depth;
      depth.resize(kCamera.width, kCamera.height);
      for (int y = 0; y < kCamera.height; ++y) {
        for (int x = 0; x < kCamera.width; ++x) {
          depth(x, y) = 1 - 0.002f * static_cast<float>(n);
        }
      }
      depths.push_back(depth);
      poses.emplace_back(Eigen::Translation3d(0, 0, 0.002 * n));
    }
  }
};

TEST_CASE("depths of a wall agree with the true poses and differ by the error of a pose",
          "[score]") {
  Walk walk;
  const double near = tolerance(1e-6, "depths near 1 m in single precision");
  CHECK(warped_disagreement(walk.depths, walk.poses, kCamera).value() < near);
  // The first and the last of six images are the only pair.
  walk.poses[5].translation().z() += 0.003;
  CHECK(std::abs(warped_disagreement(walk.depths, walk.poses, kCamera).value() - 0.003) < near);
  // Other surfaces are left out: a tenth of the picture is 0.5 m nearer.
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < kCamera.width; ++x) walk.depths[5](x, y) = 0.5F;
  }
  CHECK(std::abs(warped_disagreement(walk.depths, walk.poses, kCamera).value() - 0.003) < near);
}

TEST_CASE("unknown depths, or too few images, give no result; other sizes are refused", "[score]") {
  Walk walk;
  const std::vector<DepthImage> few(walk.depths.begin(), walk.depths.begin() + 5);
  const std::vector<Rigid3> few_poses(walk.poses.begin(), walk.poses.begin() + 5);
  CHECK_FALSE(warped_disagreement(few, few_poses, kCamera));
  CHECK_THROWS_AS(warped_disagreement(few, walk.poses, kCamera), ContractViolation);
  std::vector<DepthImage> blind = walk.depths;
  for (float& Z : blind[0]) Z = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(warped_disagreement(blind, walk.poses, kCamera));
  walk.depths[3].resize(8, 8);
  CHECK_THROWS_AS(warped_disagreement(walk.depths, walk.poses, kCamera), ContractViolation);
}

}  // namespace
}  // namespace palpable
