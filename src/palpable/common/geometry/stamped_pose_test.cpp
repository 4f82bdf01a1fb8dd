#include "palpable/common/geometry/stamped_pose.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

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
