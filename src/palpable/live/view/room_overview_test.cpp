#include "palpable/live/view/room_overview.h"

#include "palpable/live/render/orbit_camera.h"
#include "tests/support/test.h"

#include <algorithm>
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

TEST_CASE("an overview holds the room and the way through it, and fills the picture",
          "[view][room_overview]") {
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
          "[view][room_overview]") {
  const Vector3d true_up(0, 0, 1);
  for (const double pitch : {-55.0, -24.0, 0.0, 25.0}) {  // degrees, up
    INFO("pitch " << pitch);
    // Eleven normals: six of the floor, three of a wall ahead, one of a slope, one of length 0.
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
}  // namespace palpable
