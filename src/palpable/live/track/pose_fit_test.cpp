#include "palpable/live/track/pose_fit.h"

#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace palpable {
namespace {

using test::random_case;
using test::tolerance;

const TrackCamera kCamera{{1280, 720, 700, 705, 640, 360}, 0.063};

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Twist some_twist(std::mt19937_64& random, double length, double angle) {
  Twist twist;
  for (int i = 0; i < 6; ++i) twist(i) = uniform(random, -1, 1) * (i < 3 ? length : angle);
  return twist;
}

// Points in view of a camera at the world's origin, with their sightings from `camera_from_world`.
std::vector<PosePoint> some_points(std::mt19937_64& random, int count, const Rigid3& pose,
                                   double noise_px) {
  std::normal_distribution<double> noise(0, 1);
  std::vector<PosePoint> points;
  for (int i = 0; i < count; ++i) {
    PosePoint p;
    p.x_in_world = kCamera.camera.unproject(uniform(random, 100, 1180), uniform(random, 100, 620),
                                            uniform(random, 0.4, 3));
    p.seen.uvd = kCamera.see(pose * p.x_in_world) +
                 noise_px * Eigen::Vector3d(noise(random), noise(random), noise(random));
    p.seen.sigma = p.seen.sigma_d = 0.3;
    points.push_back(p);
  }
  return points;
}

TEST_CASE("a sighting names the point that it was made of", "[track]") {
  const Eigen::Vector3d x(0.11, -0.2, 0.7);
  CHECK((kCamera.point(kCamera.see(x)) - x).norm() <=
        tolerance(1e-14, "rounding of a few products"));
}

TEST_CASE("the derivatives of a sighting are those of differences", "[track]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const Rigid3 pose = moved_by(some_twist(random, 0.3, 0.5), Rigid3::Identity());
    const Eigen::Vector3d x_world(uniform(random, -1, 1), uniform(random, -1, 1), 3);
    const Eigen::Vector3d x = pose * x_world;
    const Eigen::Matrix3d D = kCamera.derivative(x);
    const Eigen::Matrix<double, 3, 6> J = pose_derivative(D, x);
    constexpr double h = 1e-6;
    for (int i = 0; i < 6; ++i) {
      Twist step = Twist::Zero();
      step(i) = h;
      const Eigen::Vector3d slope = (kCamera.see(moved_by(step, pose) * x_world) -
                                     kCamera.see(moved_by(-step, pose) * x_world)) /
                                    (2 * h);
      CHECK((slope - J.col(i)).norm() <=
            tolerance(1e-6 * (1 + J.col(i).norm()), "h^2 and rounding of 1000 px over h"));
    }
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d slope = (kCamera.see(x + e) - kCamera.see(x - e)) / (2 * h);
      CHECK((slope - D.col(i)).norm() <=
            tolerance(1e-6 * (1 + D.col(i).norm()), "h^2 and rounding of 1000 px over h"));
    }
  }
}

TEST_CASE("a rotation stays one after ten thousand steps", "[track]") {
  auto random = random_case(1);
  Rigid3 pose = Rigid3::Identity();
  for (int i = 0; i < 10'000; ++i) pose = moved_by(some_twist(random, 0.01, 0.1), pose);
  CHECK((pose.linear().transpose() * pose.linear() - Eigen::Matrix3d::Identity()).norm() <=
        tolerance(1e-14, "one product and its normalisation"));
}

TEST_CASE("exact sightings give the exact pose, with and without disparities", "[track]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const Rigid3 pose = moved_by(some_twist(random, 0.05, 0.03), Rigid3::Identity());
    std::vector<PosePoint> points = some_points(random, 60, pose, 0);
    for (std::size_t i = seed % 2; i < points.size(); i += 2) {
      points[i].seen.uvd.z() = std::numeric_limits<double>::quiet_NaN();
    }
    PoseFit fit;
    fit_pose(kCamera, points, Rigid3::Identity(), {}, fit);
    REQUIRE(fit.solved);
    CHECK(fit.inliers == 60);
    CHECK((fit.camera_from_world.matrix() - pose.matrix()).norm() <=
          tolerance(1e-9, "Gauss and Newton's method at its end"));
  }
}

TEST_CASE("a cluster that moves together does not draw the pose", "[track]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const Rigid3 pose = moved_by(some_twist(random, 0.01, 0.01), Rigid3::Identity());
    std::vector<PosePoint> points = some_points(random, 120, pose, 0.2);
    // A third of the points are on a hand that moves by 30 mm.
    const Eigen::Vector3d way(0.03, -0.01, 0.005);
    for (std::size_t i = 0; i < 40; ++i) {
      points[i].seen.uvd = kCamera.see(pose * points[i].x_in_world + way);
    }
    PoseFit fit;
    fit_pose(kCamera, points, Rigid3::Identity(), {}, fit);
    REQUIRE(fit.solved);
    const Rigid3 error = fit.camera_from_world * pose.inverse();
    CHECK(error.translation().norm() <=
          tolerance(5e-4, "0.2 px of 80 points at 1.5 m: 0.05 mm along, 0.3 mm in depth"));
    for (std::size_t i = 0; i < 40; ++i) CHECK(fit.inlier[i] == 0);
    CHECK(fit.inliers >= 75);
  }
}

TEST_CASE("too few points, or points behind the camera, give no pose", "[track]") {
  auto random = random_case(3);
  PoseFit fit;
  fit_pose(kCamera, some_points(random, 3, Rigid3::Identity(), 0), Rigid3::Identity(), {}, fit);
  CHECK_FALSE(fit.solved);
  std::vector<PosePoint> behind = some_points(random, 20, Rigid3::Identity(), 0);
  for (PosePoint& p : behind) p.x_in_world = -p.x_in_world;
  fit_pose(kCamera, behind, Rigid3::Identity(), {}, fit);
  CHECK_FALSE(fit.solved);
  CHECK(fit.inliers == 0);
}

}  // namespace
}  // namespace palpable
