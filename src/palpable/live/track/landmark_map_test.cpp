#include "palpable/live/track/landmark_map.h"

#include "palpable/live/track/picture_shift.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cmath>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

const TrackCamera kCamera{{640, 360, 350, 340, 319.5, 179.5}, 0.063};

TEST_CASE("a free slot is used again, so that other landmarks keep their index", "[track]") {
  LandmarkMap map;
  map.keyframes.resize(2);
  for (int i = 0; i < 4; ++i) {
    Landmark landmark;
    landmark.inlier = i;
    map.add(landmark, map.keyframes[0]);
  }
  CHECK(map.keyframes[0].landmarks == std::vector<int>{0, 1, 2, 3});
  CHECK(map.room_for_landmarks(10) == 6);
  map.landmarks[1].alive = false;
  CHECK(map.count_alive() == 3);
  CHECK(map.room_for_landmarks(10) == 6);  // it is dead, but its slot is not free yet
  map.free_slots = {1};
  CHECK(map.room_for_landmarks(10) == 7);
  Landmark landmark;
  landmark.inlier = 10;
  map.add(landmark, map.keyframes[1]);
  landmark.inlier = 11;
  map.add(landmark, map.keyframes[1]);
  CHECK(map.keyframes[1].landmarks == std::vector<int>{1, 4});
  CHECK(map.landmarks[1].inlier == 10);
  CHECK(map.landmarks[3].inlier == 3);
  CHECK(map.landmarks[4].inlier == 11);
  CHECK(map.count_alive() == 5);
  map.free_slots = {2};
  map.clear();
  CHECK((map.keyframes.empty() && map.landmarks.empty() && map.free_slots.empty()));
}

// A landmark at pixel (250, 120) of the anchor, 1.1 m deep, on a plane inclined by `slope`.
Landmark on_plane(const Rigid3& anchor_from_world, const Eigen::Vector2d& slope) {
  Landmark landmark;
  landmark.uv = {250, 120};
  landmark.slope = slope;
  landmark.x_in_world = anchor_from_world.inverse(Eigen::Isometry) *
                        kCamera.camera.unproject(landmark.uv.x(), landmark.uv.y(), 1.1);
  return landmark;
}

TEST_CASE("a landmark's surroundings are warped as the homography of its plane", "[track]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    const auto uniform = [&](double most) {
      return std::uniform_real_distribution<double>(-most, most)(random);
    };
    const auto some_pose = [&] {
      Twist twist;
      for (int i = 0; i < 6; ++i) twist(i) = uniform(0.15);
      return moved_by(twist, Rigid3::Identity());
    };
    const Rigid3 anchor = some_pose(), now = some_pose();
    const Landmark landmark = on_plane(anchor, {uniform(3e-4), uniform(3e-4)});
    // The plane is n . X = 1 in the anchor's frame. So 1/Z = n . (X/Z): the first two components of
    // n are f times the slope, and the third follows from 1/Z at the landmark.
    const PinholeCamera& c = kCamera.camera;
    Eigen::Vector3d n(c.fx_px * landmark.slope.x(), c.fy_px * landmark.slope.y(), 0);
    n.z() = 1 / 1.1 - n.dot(c.unproject(landmark.uv.x(), landmark.uv.y(), 1));
    const Rigid3 now_from_anchor = now * anchor.inverse(Eigen::Isometry);
    const Eigen::Matrix3d H =
        now_from_anchor.linear() + now_from_anchor.translation() * n.transpose();
    const auto warped = [&](double du, double dv) {
      return c.project(H * c.unproject(landmark.uv.x() + du, landmark.uv.y() + dv, 1));
    };
    Eigen::Matrix2d expected;
    expected.col(0) = (warped(4, 0) - warped(0, 0)) / 4;
    expected.col(1) = (warped(0, 4) - warped(0, 0)) / 4;
    CHECK((image_from_anchor(kCamera, landmark, anchor, now) - expected).norm() <=
          tolerance(1e-10, "rounding of pixels of some hundreds"));
  }
}

TEST_CASE("a wrong inclination does not throw a landmark's surroundings behind the camera",
          "[track]") {
  const Rigid3 now(Eigen::Translation3d(-0.3, 0, 0));
  // 1/Z would be negative 4 px to the right; at twice the depth the picture moves by half.
  const Landmark landmark = on_plane(Rigid3::Identity(), {-1, 0});
  const Eigen::Matrix2d A = image_from_anchor(kCamera, landmark, Rigid3::Identity(), now);
  const double shift = -0.3 * 350 / 1.1;
  CHECK(std::abs(A(0, 0) - (1 + (shift / 2 - shift) / 4)) <= tolerance(1e-10, "rounding"));
}

TEST_CASE("two poses are as far apart as the picture's most moved part", "[track]") {
  const Rigid3 here = Rigid3::Identity();
  CHECK(picture_shift_px(kCamera, 0.7, here, here) <= tolerance(1e-9, "rounding of pixels"));
  const Rigid3 aside(Eigen::Translation3d(-0.02, 0, 0));
  CHECK(std::abs(picture_shift_px(kCamera, 0.7, here, aside) - 350 * 0.02 / 0.7) <=
        tolerance(1e-9, "rounding of pixels"));
  // When the camera is nearer by a tenth, points move away from the principal point by a ninth of
  // their distance. The first of the four points, (128, 72), is farthest from it.
  const TrackCamera aslant{{640, 360, 350, 340, 400, 230}, 0.063};
  const Rigid3 nearer(Eigen::Translation3d(0, 0, -0.07));
  CHECK(std::abs(picture_shift_px(aslant, 0.7, here, nearer) -
                 std::hypot(400 - 128, 230 - 72) / 9) <= tolerance(1e-9, "rounding of pixels"));
  CHECK(picture_shift_px(kCamera, 0.7, here, Rigid3(Eigen::Translation3d(0, 0, -0.68))) == 1e9);
}

}  // namespace
}  // namespace palpable
