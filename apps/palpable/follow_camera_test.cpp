#include "apps/palpable/follow_camera.h"

#include "tests/support/test.h"

#include <cmath>
#include <vector>

namespace palpable::app {
namespace {

using Eigen::Vector3d;
using test::tolerance;

const Vector3d kUp = -Vector3d::UnitY();

// Turned to the right by `yaw` about the vertical, standing at `at`.
Rigid3 pose(const Vector3d& at, double yaw) {
  return Eigen::Translation3d(at) * Rigid3(Eigen::AngleAxisd(yaw, Vector3d::UnitY()));
}

// Where the eye is, in the frame of the camera that is followed: X right, Y down, Z forward.
Vector3d eye_beside(const FollowCamera& view, const Rigid3& world_from_camera) {
  return world_from_camera.inverse() * Vector3d(view.camera_from_world().inverse().translation());
}

TEST_CASE("the map is looked at from behind and above the camera, wherever it heads",
          "[app][follow_camera]") {
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
    // What the camera looks at is in the middle.
    const Vector3d target = seen * (camera * Vector3d(0, 0, 0.25));
    CHECK(target.head<2>().norm() < tolerance(1e-9, "rounding"));
  }
}

TEST_CASE("a camera that looks straight down is seen from below its picture's lower edge",
          "[app][follow_camera]") {
  const Rigid3 camera = Rigid3(Eigen::AngleAxisd(0.4, Vector3d::UnitY())) *
                        Rigid3(Eigen::AngleAxisd(-0.5 * std::acos(-1.0), Vector3d::UnitX()));
  REQUIRE((camera.linear().col(2) - Vector3d::UnitY()).norm() < 1e-9);
  FollowCamera view(kUp, 0.5);
  view.follow(camera, 0);
  const Vector3d eye = eye_beside(view, camera);
  CHECK(eye.y() > 0.5);
  CHECK(eye.x() > 0.2);
}

TEST_CASE("the view follows by half in 0.4 s, the shorter way round", "[app][follow_camera]") {
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
          "[app][follow_camera]") {
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

TEST_CASE("an overview holds the room and the way through it, and fills the picture",
          "[app][follow_camera]") {
  // A floor of 4 x 3 m, 1 m below a camera that crosses it.
  Eigen::Matrix3Xf points(3, 41 * 31);
  for (int i = 0; i < 41 * 31; ++i) {
    points.col(i) =
        Eigen::Vector3f(0.1f * static_cast<float>(i % 41), 1, 0.1f * static_cast<float>(i / 41));
  }
  std::vector<Rigid3> path;
  for (int n = 0; n < 30; ++n) path.push_back(pose({2, 0, 0.1 * n}, 0));
  const PinholeCamera camera = camera_of_view(640, 360, 0.9);
  const Rigid3 view = overview(points, path, kUp, camera);
  int inside = 0;
  double most = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d x = view * points.col(i).cast<double>();
    REQUIRE(x.z() > 0);
    const Eigen::Vector2d p = camera.project(x);
    if (p.x() > 0 && p.y() > 0 && p.x() < 639 && p.y() < 359) ++inside;
    most = std::max({most, std::abs(p.x() - 319.5) / 320, std::abs(p.y() - 179.5) / 180});
  }
  CHECK(inside > 0.96 * static_cast<double>(points.cols()));
  CHECK(most > 0.85);
  for (const Rigid3& at : path) {
    const Eigen::Vector2d p = camera.project(view * Vector3d(at.translation()));
    CHECK((p.x() > 0 && p.y() > 0 && p.x() < 639 && p.y() < 359));
  }
  CHECK((view.linear() * kUp).y() < -0.5);  // from above, upright
}

TEST_CASE("up is found from the floor of a room, however its camera looked and whatever its world",
          "[app][map]") {
  const Vector3d true_up(0, 0, 1);
  for (const double pitch : {-55.0, -24.0, 0.0, 25.0}) {  // degrees, up
    INFO("pitch " << pitch);
    // Of eleven normals six are the floor's, three those of a wall ahead, one a slope's, one none.
    const Vector3d wall = Vector3d(0, -1, 0);  // the camera looks along Y
    Eigen::Matrix3Xf normals(3, 11);
    for (int i = 0; i < 6; ++i) normals.col(i) = true_up.cast<float>();
    for (int i = 6; i < 9; ++i) normals.col(i) = wall.cast<float>();
    normals.col(9) = (true_up + 0.3 * wall).normalized().cast<float>();
    normals.col(10).setZero();
    Rigid3 world_from_camera = Rigid3::Identity();
    world_from_camera.linear().col(0) = Vector3d::UnitX();
    world_from_camera.linear().col(1) = -Vector3d::UnitZ();
    world_from_camera.linear().col(2) = Vector3d::UnitY();
    world_from_camera.rotate(Eigen::AngleAxisd(pitch / 180 * 3.14159265, Vector3d::UnitX()));
    CHECK((world_from_camera.linear().col(2).z() > 0) == (pitch > 0));
    const Vector3d found = up_of_room(normals, world_from_camera);
    CHECK(std::acos(found.dot(true_up)) < tolerance(1e-3, "the slope is out in the last round"));
    CHECK(up_of_room(Eigen::Matrix3Xf::Zero(3, 4), world_from_camera) ==
          -world_from_camera.linear().col(1).cast<float>().cast<double>().normalized());
  }
}

}  // namespace
}  // namespace palpable::app
