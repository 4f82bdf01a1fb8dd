#include "palpable/live/stereo/row_watch.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"
#include "tests/support/tilted_pair.h"

#include <cmath>
#include <optional>

namespace palpable {
namespace {

using test::kTiltedDisparity;
using test::tilted_pair;
using test::TiltedPair;

constexpr int kWidth = test::kTiltedWidth;
constexpr int kHeight = test::kTiltedHeight;

const PinholeCamera kCamera = test::tilted_stereo().camera;

// The exact disparities, for images at half the size.
Disparities true_disparity() {
  return {kWidth / 2, kHeight / 2,
          static_cast<std::int16_t>(kTiltedDisparity / 2 * kDisparitySteps)};
}

RowError measured(const TiltedPair& pair) {
  RowWatch watch(kCamera);
  return watch.measure(pair.left, pair.right, true_disparity(),
                       GrayImage(kWidth / 2, kHeight / 2, 255), 2);
}

double degrees(double d) { return d * M_PI / 180; }

TEST_CASE("pitch and roll between the eyes are read off the rows of matched points",
          "[stereo][rows]") {
  for (const EyeTilt& tilt : {EyeTilt{0, 0}, EyeTilt{degrees(0.05), 0}, EyeTilt{degrees(-0.15), 0},
                              EyeTilt{degrees(0.1), degrees(0.1)}, EyeTilt{0, degrees(-0.2)}}) {
    INFO("pitch " << tilt.pitch << ", roll " << tilt.roll);
    const RowError error = measured(tilted_pair(tilt, 1));
    REQUIRE(error.points >= 20);
    // 0.05 degrees of pitch are 0.31 px.
    CHECK(std::abs(error.tilt.pitch - tilt.pitch) * 350 <=
          test::tolerance(0.12, "px; grey levels are rounded, a roll leaks into the fit"));
    CHECK(std::abs(error.tilt.roll - tilt.roll) * 320 <=
          test::tolerance(0.12, "px at the side; the regularised fit takes a little off"));
    CHECK(std::abs(error.median_px - 350 * tilt.pitch) <=
          test::tolerance(0.15, "px; roll moves the median where points lie unevenly"));
  }
}

TEST_CASE("a correction is due when an error lasts, and not before", "[stereo][rows]") {
  const TiltedPair pair = tilted_pair({degrees(0.08), 0}, 2);
  const TiltedPair straight = tilted_pair({}, 2);
  RowWatch watch(kCamera);
  const Disparities d = true_disparity();
  const GrayImage sure(kWidth / 2, kHeight / 2, 255);
  const auto look = [&](const TiltedPair& seen) {
    watch.measure(seen.left, seen.right, d, sure, 2);
    return watch.correction_due();
  };
  for (int i = 0; i < 20; ++i) CHECK_FALSE(look(straight).has_value());
  std::optional<EyeTilt> due;
  int frames = 0;
  while (!due && frames < 30) {
    due = look(pair);
    ++frames;
  }
  REQUIRE(due.has_value());
  CHECK(frames >= 3 * static_cast<int>(RowWatch::kFrames) / 4);
  CHECK(frames <= static_cast<int>(RowWatch::kFrames));
  CHECK(std::abs(due->pitch - degrees(0.08)) * 350 <= test::tolerance(0.03, "px"));
  CHECK_FALSE(watch.correction_due().has_value());  // the history was cleared
  // Pixels with low confidence or unknown disparity give no points.
  RowWatch other(kCamera);
  CHECK(other.measure(pair.left, pair.right, d, GrayImage(kWidth / 2, kHeight / 2, 40), 2).points ==
        0);
  CHECK(std::isnan(other.last().median_px));
  const Disparities nothing(kWidth / 2, kHeight / 2, kUnknownDisparity);
  CHECK(other.measure(pair.left, pair.right, nothing, sure, 2).points == 0);
}

TEST_CASE("watching takes no memory after the first frame", "[stereo][rows]") {
  const TiltedPair pair = tilted_pair({degrees(0.02), 0}, 3);
  RowWatch watch(kCamera);
  const Disparities d = true_disparity();
  const GrayImage sure(kWidth / 2, kHeight / 2, 255);
  CHECK(test::allocations_during([&] {
          for (int i = 0; i < 10; ++i) {
            watch.measure(pair.left, pair.right, d, sure, 2);
            static_cast<void>(watch.correction_due());
          }
        }) == 0);
}

}  // namespace
}  // namespace palpable
