#include "palpable/common/geometry/rigid.h"

#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <vector>

namespace palpable {
namespace {

using test::tolerance;

Rigid3 pose(double x, double turn) {
  return Eigen::Translation3d(x, 2, 3) * Rigid3(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitX()));
}

TEST_CASE("the median of one pose is that pose", "[geometry][median_pose]") {
  const std::vector<Rigid3> poses{pose(1, 0.4)};
  CHECK((median_pose(poses, 0.1).matrix() - poses[0].matrix()).norm() <
        tolerance(1e-15, "through a quaternion"));
}

TEST_CASE("measurements that scatter are averaged", "[geometry][median_pose]") {
  // Scattered around x = 1 and 3.14 rad, where quaternions change their sign; the nearest half is
  // nearly symmetric.
  std::vector<Rigid3> poses;
  for (const int i : {-3, -2, -1, 0, 1, 2, 3}) poses.push_back(pose(1 + 0.01 * i, 3.14 + 0.02 * i));
  const Rigid3 found = median_pose(poses, 0.1);
  const Rigid3 error = found.inverse() * pose(1, 3.14);
  CHECK(error.translation().norm() < 0.006);  // four poses: one has no counterpart
  CHECK(Eigen::AngleAxisd(error.linear()).angle() < 0.011);
}

TEST_CASE("outliers change nothing while they are fewer than half of the poses",
          "[geometry][median_pose]") {
  std::vector<Rigid3> poses{pose(9, 0),       pose(-4, 2), pose(1, 0.5), pose(1.001, 0.5),
                            pose(0.999, 0.5), pose(7, 1),  pose(1, 0.5)};
  const Rigid3 found = median_pose(poses, 0.1);
  CHECK(std::abs(found.translation().x() - 1) < 0.0011);
  CHECK(Eigen::AngleAxisd(found.linear() * pose(0, 0.5).linear().transpose()).angle() < 1e-7);
}

// The path of a camera whose x (m) equals the time (s).
std::vector<StampedPose> path_at(const std::vector<double>& times) {
  std::vector<StampedPose> path;
  for (const double time : times) {
    path.push_back({time, Rigid3(Eigen::Translation3d(time, 0, 0))});
  }
  return path;
}

TEST_CASE("the pose nearest in time, before or after, and none that is too far away",
          "[geometry][stamped_pose]") {
  const std::vector<StampedPose> path = path_at({1, 2, 4});
  const auto x_at = [&](double time) -> std::optional<double> {
    const std::optional<Rigid3> pose = pose_nearest(path, time, 0.75);
    if (!pose) return std::nullopt;
    return pose->translation().x();
  };
  CHECK(x_at(0.5) == 1);
  CHECK(x_at(1) == 1);
  CHECK(x_at(1.4) == 1);
  CHECK(x_at(1.5) == 2);  // as near to both: the later one
  CHECK(x_at(1.6) == 2);
  CHECK(x_at(2.75) == 2);
  CHECK(x_at(4.75) == 4);
  CHECK_FALSE(x_at(0.2).has_value());
  CHECK_FALSE(x_at(3).has_value());
  CHECK_FALSE(x_at(4.8).has_value());
  CHECK_FALSE(pose_nearest({}, 1, 10).has_value());
}

}  // namespace

}  // namespace palpable
