#include "palpable/live/view/follow_camera.h"

#include "tests/support/test.h"

#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

const Vector3d kUp = -Vector3d::UnitY();

// The pose of a camera at `at` that is turned to the right by `yaw` about the vertical.
Rigid3 pose(const Vector3d& at, double yaw) {
  return Eigen::Translation3d(at) * Rigid3(Eigen::AngleAxisd(yaw, Vector3d::UnitY()));
}

// The position of the eye in the frame of the camera that it follows: X right, Y down, Z forward.
Vector3d eye_beside(const FollowCamera& view, const Rigid3& world_from_camera) {
  return world_from_camera.inverse() * Vector3d(view.camera_from_world().inverse().translation());
}

TEST_CASE("the map is seen from behind and above the camera, whatever the camera's heading",
          "[view][follow_camera]") {
  std::vector<Vector3d> eyes;
  for (const double yaw : {0.0, 0.7, -2.5, 3.1}) {
    const Rigid3 camera = pose({0.3, -1, 2}, yaw);
    FollowCamera view(kUp, 0.5);
    view.follow(camera, 5);
    eyes.push_back(eye_beside(view, camera));
    CHECK(eyes.back().x() > 0.2);  // over the right shoulder
    CHECK(eyes.back().y() < -0.5);
    CHECK(eyes.back().z() < -0.4);
    CHECK((eyes.back() - eyes.front()).norm() < tolerance(1e-9, "rounding"));
    const Rigid3 seen = view.camera_from_world();
    CHECK(std::abs((seen.linear() * kUp).x()) < tolerance(1e-9, "rounding"));
    CHECK((seen.linear() * kUp).y() < 0);  // upright
    // The point that the camera looks at is in the middle of the picture.
    const Vector3d target = seen * (camera * Vector3d(0, 0, 0.25));
    CHECK(target.head<2>().norm() < tolerance(1e-9, "rounding"));
  }
}

TEST_CASE("a camera that looks straight down is seen from below its picture's lower edge",
          "[view][follow_camera]") {
  const Rigid3 camera = Rigid3(Eigen::AngleAxisd(0.4, Vector3d::UnitY())) *
                        Rigid3(Eigen::AngleAxisd(-0.5 * std::acos(-1.0), Vector3d::UnitX()));
  REQUIRE((camera.linear().col(2) - Vector3d::UnitY()).norm() < 1e-9);
  FollowCamera view(kUp, 0.5);
  view.follow(camera, 0);
  const Vector3d eye = eye_beside(view, camera);
  CHECK(eye.y() > 0.5);
  CHECK(eye.x() > 0.2);
}

TEST_CASE("the view follows by half in 0.4 s, the shorter way round", "[view][follow_camera]") {
  FollowCamera view(kUp, 0.5);
  view.follow(pose({0, 0, 0}, 3.0), 0);
  const Rigid3 before = view.camera_from_world();
  const Rigid3 next = pose({0, 0, 0}, -3.0);  // 0.28 rad on
  FollowCamera there(kUp, 0.5);
  there.follow(next, 0);
  view.follow(next, 0.4);
  const double all =
      Eigen::AngleAxisd(before.linear() * there.camera_from_world().linear().transpose()).angle();
  const double done =
      Eigen::AngleAxisd(before.linear() * view.camera_from_world().linear().transpose()).angle();
  CHECK(all < 0.3);
  CHECK(done == Approx(0.5 * all).epsilon(0.02));
  for (int n = 0; n < 100; ++n) view.follow(next, 0.5 + 0.1 * n);
  CHECK((view.camera_from_world().matrix() - there.camera_from_world().matrix()).norm() < 1e-6);
}

TEST_CASE("the mouse turns the view, the wheel comes nearer, R takes both back",
          "[view][follow_camera]") {
  const Rigid3 camera = pose({0, 0, 0}, 0);
  FollowCamera view(kUp, 0.5);
  view.follow(camera, 0);
  const Vector3d usual = eye_beside(view, camera);
  using Kind = WindowEvent::Kind;
  CHECK_FALSE(view.handle({.kind = Kind::kMove, .x_px = 500, .y_px = 100}));  // no button
  CHECK(eye_beside(view, camera) == usual);
  view.handle({.kind = Kind::kPress, .x_px = 500, .y_px = 100});
  CHECK(view.handle({.kind = Kind::kMove, .x_px = 400, .y_px = 100}));
  view.handle({.kind = Kind::kRelease, .x_px = 400, .y_px = 100});
  view.handle({.kind = Kind::kMove, .x_px = 700, .y_px = 100});
  CHECK(eye_beside(view, camera).x() >
        usual.x() + 0.1);  // what is grabbed follows: the eye goes right
  view.follow(camera, 1);
  CHECK(eye_beside(view, camera).x() > usual.x() + 0.1);  // and stays there
  view.handle({.kind = Kind::kWheel, .x_px = 700, .y_px = 100, .wheel = 3});
  const Vector3d target(0, 0, 0.25);
  CHECK((eye_beside(view, camera) - target).norm() < 0.8 * (usual - target).norm());
  view.handle({.kind = Kind::kKey, .key = 'R'});
  CHECK((eye_beside(view, camera) - usual).norm() < tolerance(1e-12, "rounding"));
}

TEST_CASE("another button's release does not end turning", "[view][follow_camera]") {
  const Rigid3 camera = pose({0, 0, 0}, 0);
  FollowCamera view(kUp, 0.5);
  view.follow(camera, 0);
  using Kind = WindowEvent::Kind;
  view.handle({.kind = Kind::kPress, .x_px = 500, .y_px = 100});
  view.handle({.kind = Kind::kPress, .x_px = 500, .y_px = 100, .button = 1});
  view.handle({.kind = Kind::kRelease, .x_px = 500, .y_px = 100, .button = 1});
  CHECK(view.handle({.kind = Kind::kMove, .x_px = 400, .y_px = 100}));
  view.handle({.kind = Kind::kRelease, .x_px = 400, .y_px = 100});
  CHECK_FALSE(view.handle({.kind = Kind::kMove, .x_px = 300, .y_px = 100}));
}

}  // namespace
}  // namespace palpable
