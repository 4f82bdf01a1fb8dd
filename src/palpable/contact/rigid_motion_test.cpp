#include "palpable/contact/rigid_motion.h"

#include "tests/support/allocations.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::Capsule;
using test::tolerance;

constexpr PinholeCamera kCamera{161, 121, 350, 350, 80, 60};

// A hand of a thumb and two fingers: no motion of it looks like none.
std::vector<Capsule> hand() {
  return {{{-0.03, 0.0, 0.40}, {0.03, 0.004, 0.405}, 0.008},
          {{-0.03, 0.0, 0.40}, {-0.01, 0.03, 0.39}, 0.009},
          {{-0.03, 0.0, 0.40}, {-0.035, -0.03, 0.41}, 0.008}};
}

std::vector<Capsule> moved(const Rigid3& motion, std::vector<Capsule> things) {
  for (Capsule& thing : things) {
    thing.a = motion * thing.a;
    thing.b = motion * thing.b;
  }
  return things;
}

// Every third pixel of what is seen, with the true normals.
std::vector<FrontPoint> front_of(const std::vector<Capsule>& things, const Rigid3& body_from_camera) {
  const DepthImage depth = test::depth_of(things, kCamera);
  std::vector<FrontPoint> points;
  for (int y = 0; y < kCamera.height; y += 3) {
    for (int x = 0; x < kCamera.width; x += 3) {
      if (std::isnan(depth(x, y))) continue;
      const Vector3d p = kCamera.unproject(x, y, static_cast<double>(depth(x, y)));
      Vector3d normal;
      for (int k = 0; k < 3; ++k) {
        const Vector3d step = 1e-6 * Vector3d::Unit(k);
        normal[k] = test::distance_to(things, p + step) - test::distance_to(things, p - step);
      }
      points.push_back({(body_from_camera * p).cast<float>(),
                        (body_from_camera.linear() * normal.normalized()).cast<float>()});
    }
  }
  return points;
}

Rigid3 some_pose() {
  Rigid3 body_from_camera = Rigid3::Identity();
  body_from_camera.linear() =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  body_from_camera.translation() = Vector3d(0.1, -0.2, 0.05);
  return body_from_camera;
}

TEST_CASE("a hand's motion is found from what is seen of it", "[contact][motion]") {
  const Rigid3 body_from_camera = some_pose();
  for (const double share : {0.0, 0.5, 1.0}) {
    INFO("share " << share);
    // 14 mm and 6 degrees in a frame: 0.4 m/s.
    Rigid3 motion = Rigid3::Identity();
    motion.linear() =
        Eigen::AngleAxisd(0.1 * share, Vector3d(1, -1, 2).normalized()).toRotationMatrix();
    motion.translation() = share * Vector3d(0.012, -0.006, 0.004) +
                           Vector3d(0, 0, 0.4) - motion.linear() * Vector3d(0, 0, 0.4);
    const DepthImage depth = test::depth_of(moved(motion, hand()), kCamera);
    const auto found = rigid_motion(front_of(hand(), body_from_camera),
                                    {depth, {}, kCamera, body_from_camera.inverse()},
                                    Rigid3::Identity());
    REQUIRE(found);
    CHECK(found->agreeing > 0.9 * found->points);
    const Rigid3 in_camera =
        body_from_camera.inverse() * found->now_from_before * body_from_camera;
    const Vector3d at(0, 0, 0.4);
    CHECK((in_camera * at - motion * at).norm() < tolerance(4e-4, "a pixel is 1.1 mm"));
    CHECK(Eigen::AngleAxisd(in_camera.linear().transpose() * motion.linear()).angle() <
          tolerance(0.012, "half a pixel over a hand of 50 mm"));
  }
}

TEST_CASE("what the surface does not tell stays as it was guessed", "[contact][motion]") {
  // A finger through the whole picture may slide along its axis unseen.
  const Capsule finger{{-0.3, 0, 0.4}, {0.3, 0, 0.4}, 0.008};
  const auto front = front_of({finger}, Rigid3::Identity());
  const DepthImage depth = test::depth_of({finger}, kCamera);
  for (const double along : {0.0, 0.004}) {
    Rigid3 guess = Rigid3::Identity();
    guess.translation().x() = along;
    const auto found = rigid_motion(front, {depth, {}, kCamera, Rigid3::Identity()}, guess);
    REQUIRE(found);
    CHECK(found->now_from_before.translation().x() == Approx(along).margin(5e-4));
    CHECK(found->now_from_before.translation().tail<2>().norm() < 2e-4);
  }
}

TEST_CASE("a thing that is not there any more has no motion", "[contact][motion]") {
  const auto front = front_of(hand(), Rigid3::Identity());
  const DepthImage nothing = test::depth_of({}, kCamera);
  CHECK_FALSE(rigid_motion(front, {nothing, {}, kCamera, Rigid3::Identity()}, Rigid3::Identity()));
  // Seen, but not what presses.
  const DepthImage same = test::depth_of(hand(), kCamera);
  const MaskImage room(kCamera.width, kCamera.height, kShowsRoom);
  CHECK_FALSE(rigid_motion(front, {same, room, kCamera, Rigid3::Identity()}, Rigid3::Identity()));
  // Too few points.
  CHECK_FALSE(rigid_motion(std::span(front).first(5), {same, {}, kCamera, Rigid3::Identity()},
                           Rigid3::Identity()));
  // 6 cm in one frame is not followed, and not taken for something else.
  Rigid3 jump = Rigid3::Identity();
  jump.translation() = Vector3d(0.0, 0.06, 0.0);
  const DepthImage far = test::depth_of(moved(jump, hand()), kCamera);
  CHECK_FALSE(rigid_motion(front, {far, {}, kCamera, Rigid3::Identity()}, Rigid3::Identity()));
}

TEST_CASE("finding a motion allocates nothing", "[contact][motion][frame loop]") {
  const auto front = front_of(hand(), Rigid3::Identity());
  const DepthImage depth = test::depth_of(hand(), kCamera);
  const MaskImage all;
  const FrontView view{depth, all, kCamera, Rigid3::Identity()};
  std::optional<RigidMotion> found;
  CHECK(test::allocations_during(
            [&] { found = rigid_motion(front, view, Rigid3::Identity()); }) == 0);
  CHECK(found);
}

}  // namespace
}  // namespace palpable
