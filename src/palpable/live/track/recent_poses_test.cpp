#include "palpable/live/track/recent_poses.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

const TrackCamera kCamera{{640, 360, 350, 350, 319.5, 179.5}, 0.063};
constexpr double kDepth = 1;    // m
constexpr double kStep = 0.05;  // s between frames

Rigid3 at(double x) { return Rigid3(Eigen::Translation3d(-x, 0, 0)); }  // camera_from_world

TEST_CASE("a camera has come to rest when its picture has not moved for 0.7 s, and not sooner",
          "[track][states]") {
  RecentPoses poses;
  for (int n = 0; n < 40; ++n) {
    INFO("frame " << n);
    // Noise of 0.05 px.
    const bool rests =
        poses.add_and_check_rest(kCamera, kDepth, n * kStep, at(n % 2 == 0 ? 0 : 0.05 / 350));
    if (n <= 13) CHECK_FALSE(rests);
    if (n >= 15) CHECK(rests);
  }
  // One frame 1 px away, and back.
  CHECK_FALSE(poses.add_and_check_rest(kCamera, kDepth, 40 * kStep, at(1.0 / 350)));
  for (int n = 41; n < 60; ++n) {
    INFO("frame " << n);
    const bool rests = poses.add_and_check_rest(kCamera, kDepth, n * kStep, at(0));
    if (n <= 53) CHECK_FALSE(rests);
    if (n >= 56) CHECK(rests);
  }
}

TEST_CASE("a camera at rest still rests when the world is moved under it", "[track][states]") {
  const Rigid3 old_world_from_world(Eigen::Translation3d(0.1, 0, 0.2));
  for (const bool is_moved : {true, false}) {
    RecentPoses poses;
    for (int n = 0; n < 20; ++n) poses.add_and_check_rest(kCamera, kDepth, n * kStep, at(0));
    if (is_moved) poses.move_world(old_world_from_world);
    CHECK(poses.add_and_check_rest(kCamera, kDepth, 20 * kStep, at(0) * old_world_from_world) ==
          is_moved);
  }
}

}  // namespace
}  // namespace palpable
