#include "palpable/live/track/exposure_estimate.h"

#include "tests/support/noise_wall.h"
#include "tests/support/test.h"

#include <cmath>
#include <map>
#include <optional>
#include <vector>

namespace palpable {
namespace {

using test::kPxPerMetre;
using test::standing_at;
using test::tolerance;
using test::WallMap;
using test::WallView;

const TrackerSettings kSettings = test::noise_wall_settings();

// The camera moves by 24 px from frame to frame.
constexpr double kMotion = 24 / kPxPerMetre;  // m
const Rigid3 kBefore = standing_at(0.02 - kMotion, 0, 0);
const Rigid3 kNow = standing_at(0.02, 0, 0);

// A picture with a shutter that is open for `share` of the frame time; in the middle of that time
// the camera is at kNow. It is the mean of one picture for each pixel of motion.
struct SmearedView : WallView {
  explicit SmearedView(double share) : WallView(kNow, moments(share), false) {}
  static std::vector<Rigid3> moments(double share) {
    std::vector<Rigid3> poses;
    const int count = static_cast<int>(24 * share) + 1;
    for (int i = 0; i < count; ++i) {
      const double when = share * ((i + 0.5) / count - 0.5);
      poses.push_back(standing_at(0.02 + when * kMotion, 0, 0));
    }
    return poses;
  }
};

// Painted once for each share.
const SmearedView& smeared_view(double share) {
  static std::map<double, SmearedView> views;
  return views.try_emplace(share, share).first->second;
}

// Finds the pose in a smeared picture and measures the exposure.
void measure(ExposureEstimate& exposure, double true_share, const LandmarkMap& map,
             int frame_count) {
  const SmearedView& view = smeared_view(true_share);
  const LandmarkSearch search{kSettings, view.pyramid, map};
  PoseSearch pose_search(kSettings);
  REQUIRE(pose_search.find(search, view.frame,
                           {.guess = kNow,
                            .previous = kBefore,
                            .coarse_first = false,
                            .least_inliers = 5,
                            .exposure = true_share}));
  exposure.measure(search, pose_search, kNow, kBefore, frame_count);
}

TEST_CASE("the share of the frame time that the shutter is open is measured from the smear",
          "[track]") {
  const WallMap map(test::first_wall_view(), 10, 5);
  for (const double share : {0.0, 0.12, 0.24, 0.5}) {
    INFO("share " << share);
    ExposureEstimate exposure;
    CHECK(exposure.share() == 0.0);
    measure(exposure, share, map, 1);
    // All four are among the shares that are tried, so the result is exact.
    CHECK(std::abs(exposure.share() - share) <=
          tolerance(share > 0 ? 0 : 0.12,
                    "sampling between pixels blurs a sharp picture as the smallest smear does"));
  }
}

TEST_CASE("once it is known, the exposure follows in every fourth frame by 0.3", "[track]") {
  const WallMap map(test::first_wall_view(), 10, 5);
  ExposureEstimate exposure;
  measure(exposure, 0.12, map, 1);
  REQUIRE(exposure.share() == 0.12);
  for (const int frame : {2, 3, 5}) {
    measure(exposure, 0.5, map, frame);
    CHECK(exposure.share() == 0.12);
  }
  measure(exposure, 0.5, map, 8);
  CHECK(std::abs(exposure.share() - (0.12 + 0.3 * (0.5 - 0.12))) <=
        tolerance(1e-15, "rounding of three operations"));
}

TEST_CASE("seven landmarks are too few to measure the exposure by, eight are enough", "[track]") {
  for (const int landmarks : {7, 8}) {
    INFO(landmarks << " landmarks");
    WallMap map(test::first_wall_view(), 4, 2);
    if (landmarks == 7) map.landmarks[3].alive = false;
    ExposureEstimate exposure;
    measure(exposure, 0.36, map, 1);
    CHECK(exposure.share() == (landmarks == 8 ? 0.36 : 0.0));
  }
}

}  // namespace
}  // namespace palpable
