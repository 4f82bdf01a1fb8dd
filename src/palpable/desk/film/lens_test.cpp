#include "palpable/desk/film/lens.h"

#include "palpable/desk/script/rig.h"
#include "tests/support/test.h"

#include <cmath>
#include <numeric>
#include <vector>

using namespace palpable;
using palpable::test::tolerance;

TEST_CASE("projecting the ray of a pixel gives the pixel", "[film]") {
  const StereoRig rig = zed_mini_rig();
  for (const DistortedCamera& camera : {rig.left, rig.right})
    for (int v = 0; v < 720; v += 37)
      for (int u = 0; u < 1280; u += 41) {
        const Eigen::Vector2d ray = undistorted_ray(camera, Eigen::Vector2d(u, v));
        const Eigen::Vector2d again = camera.project(3.0 * ray.homogeneous());
        if ((again - Eigen::Vector2d(u, v)).norm() > tolerance(1e-8, "Newton to 1e-12 rad"))
          FAIL("pixel " << u << " " << v << " comes back as " << again.transpose());
      }
}

TEST_CASE("the ideal picture holds every raw pixel", "[film]") {
  const DistortedCamera camera = zed_mini_rig().left;
  const PinholeCamera ideal = ideal_camera_for(camera, camera.pinhole.fx_px);
  const std::vector<Eigen::Vector2f> map = distortion_map(camera, ideal);
  REQUIRE(map.size() == 1280U * 720U);
  for (const Eigen::Vector2f& at : map)
    if (!(at.x() >= 1.0F && at.y() >= 1.0F && at.x() <= static_cast<float>(ideal.width - 2) &&
          at.y() <= static_cast<float>(ideal.height - 2)))
      FAIL("the light of a pixel comes from " << at.transpose());
  // It is not much larger than needed: this barrel distortion widens the picture by a quarter.
  CHECK(ideal.width < 1.45 * 1280);
}

TEST_CASE("only pixels that the lens reads, and a margin round them, may be painted", "[film]") {
  // A camera of 3 x 2 pixels that all read near one position, one of them at (9.5, 6.25).
  const PinholeCamera ideal{24, 16, 10, 10, 12, 8};
  const std::vector<Eigen::Vector2f> map = {{9, 6}, {9.5F, 6.25F}, {9, 6}, {9, 6}, {9, 6}, {9, 6}};
  for (const int margin : {0, 2}) {
    const std::vector<float> depth = depth_where_seen(map, ideal, margin);
    REQUIRE(depth.size() == 24U * 16U);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 24; ++x) {
        INFO("margin " << margin << ", pixel " << x << " " << y);
        // Bilinear filtering reads columns 9 and 10 of rows 6 and 7.
        const bool read = x >= 9 - margin && x <= 10 + margin && y >= 6 - margin && y <= 7 + margin;
        CHECK(depth[24 * y + x] == (read ? 1.0F : 0.0F));
      }
  }
  // Most of the picture of the real lens, but not its corners and not the middles of its sides.
  const DistortedCamera camera = zed_mini_rig().left;
  const PinholeCamera whole = ideal_camera_for(camera, camera.pinhole.fx_px);
  const std::vector<float> seen = depth_where_seen(distortion_map(camera, whole), whole, 0);
  const double share =
      std::accumulate(seen.begin(), seen.end(), 0.0) / static_cast<double>(seen.size());
  CHECK(share < 0.85);
  CHECK(share > 0.75);
}

TEST_CASE("the rig has the numbers of a ZED Mini", "[film]") {
  const StereoRig rig = zed_mini_rig();
  CHECK(std::abs(rig.right_from_left.translation().norm() - 0.06302) < 1e-4);
  CHECK(rig.right_from_left.translation().x() < 0.0);
  const Eigen::AngleAxisd turn(rig.right_from_left.linear());
  CHECK(turn.angle() > 0.002);
  CHECK(turn.angle() < 0.005);
}

TEST_CASE("the faults of a rig are within their bounds and not zero", "[film]") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    INFO("seed " << seed);
    const SensorFaults faults = sensor_faults(seed);
    CHECK(std::abs(faults.right_gain - 1.0) <= 0.03);
    CHECK(std::abs(faults.right_gain - 1.0) >= 0.01);
    CHECK(std::abs(faults.row_error_px) <= 0.1);
    CHECK(std::abs(faults.row_error_px) >= 0.03);
  }
}
