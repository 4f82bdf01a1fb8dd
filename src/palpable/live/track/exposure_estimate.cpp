#include "palpable/live/track/exposure_estimate.h"

#include "palpable/live/track/picture_shift.h"

#include <algorithm>
#include <array>

namespace palpable {
namespace {

constexpr std::array kShares{0.0, 0.12, 0.24, 0.36, 0.5, 0.7};  // candidates
using Likenesses = std::array<double, kShares.size()>;
constexpr int kLevel = 1;           // level of the pyramid at which patches are compared
constexpr int kMostLandmarks = 24;  // largest and smallest number of landmarks compared
constexpr int kLeastLandmarks = 8;
constexpr int kMeasureEvery = 4;     // frames between measurements after the first
constexpr double kShareOfNew = 0.3;  // weight of a new measurement in the average

}  // namespace

void ExposureEstimate::measure(const LandmarkSearch& search, const PoseSearch& seen,
                               const Rigid3& camera_from_world, const Rigid3& previous_from_world,
                               int frame_count) {
  if (known_ && frame_count % kMeasureEvery != 0) return;
  const PinholeCamera& camera = search.settings.camera.camera;
  Likenesses sums{};
  int count = 0;
  seen.for_each_inlier([&](const Candidate& candidate, const PosePoint& point) {
    if (count >= kMostLandmarks) return;
    const Landmark& landmark = search.map.landmarks[candidate.landmark];
    const Eigen::Vector3d now = camera_from_world * landmark.x_in_world;
    const Eigen::Vector3d then = previous_from_world * landmark.x_in_world;
    if (now.z() < kNearestSeen || then.z() < kNearestSeen) return;
    const Eigen::Vector2d motion = camera.project(now) - camera.project(then);
    const Eigen::Vector2d at = Pyramid::to_level(point.seen.uvd.head<2>(), kLevel);
    Likenesses each{};
    for (std::size_t e = 0; e < kShares.size(); ++e) {
      PatchTemplate look;
      // At level 1 the picture moves by half as many pixels.
      if (!look.warp(landmark.look, kLevel, candidate.warp, kShares[e] / 2 * motion)) return;
      each[e] = likeness_at(search.pyramid.level(kLevel), look, at);
    }
    for (std::size_t e = 0; e < each.size(); ++e) sums[e] += each[e];
    ++count;
  });
  if (count < kLeastLandmarks) return;
  const auto best = std::max_element(sums.begin(), sums.end()) - sums.begin();
  share_ += (known_ ? kShareOfNew : 1.0) * (kShares[best] - share_);
  known_ = true;
}

}  // namespace palpable
