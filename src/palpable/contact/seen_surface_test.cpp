#include "palpable/contact/seen_surface.h"

#include "palpable/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::Capsule;
using test::tolerance;

// As the stereo chain gives it: f = 350 px at half resolution. 161 x 121 keeps the debug build
// quick.
constexpr PinholeCamera kCamera{161, 121, 350, 350, 80, 60};

// A body frame that agrees with no axis of the camera, so that a swapped transform shows.
Rigid3 some_pose() {
  Rigid3 body_from_camera = Rigid3::Identity();
  body_from_camera.linear() =
      (Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())).toRotationMatrix();
  body_from_camera.translation() = Vector3d(0.1, -0.2, 0.05);
  return body_from_camera;
}

Eigen::AlignedBox3d box_around(const Vector3d& centre, double half_side) {
  return {centre - Vector3d::Constant(half_side), centre + Vector3d::Constant(half_side)};
}

TEST_CASE("the points of a seen plane lie on it and their normals face the camera",
          "[contact][seen surface]") {
  // A plane through (0, 0, 0.4) tilted by 45 degrees: z = 0.4 + x + 0.3 y.
  DepthImage depth(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Vector3d ray = kCamera.unproject(u, v, 1.0);
      depth(u, v) = static_cast<float>(0.4 / (1 - ray.x() - 0.3 * ray.y()));
    }
  }
  const Rigid3 body_from_camera = some_pose();
  const Vector3d normal = body_from_camera.linear() * Vector3d(1, 0.3, -1).normalized();
  const Vector3d on_plane = body_from_camera * Vector3d(0, 0, 0.4);
  SeenSurface seen;
  seen.build(depth, kCamera, body_from_camera, box_around(on_plane, 0.03));
  REQUIRE(seen.points().size() > 100);
  for (const SeenPoint& point : seen.points()) {
    CHECK(std::abs((point.point.cast<double>() - on_plane).dot(normal)) <
          tolerance(1e-6, "floats of half a metre"));
    CHECK((point.normal.cast<double>() - normal).norm() <
          tolerance(1e-4, "float depth (3e-8 m) over a window of 4 px of 1 mm"));
  }
}

TEST_CASE("the seen front of a finger stands for the whole finger", "[contact][seen surface]") {
  // Across the view, 0.4 m away, as thick as the settings assume.
  SeenSurfaceSettings settings;
  settings.step = 1;
  const Capsule finger{{-0.05, 0.004, 0.40}, {0.03, -0.006, 0.41}, settings.thickness / 2};
  const DepthImage depth = test::depth_of({finger}, kCamera);
  const Rigid3 body_from_camera = some_pose();
  SeenSurface seen(settings);
  seen.build(depth, kCamera, body_from_camera,
             box_around(body_from_camera * Vector3d(-0.01, 0, 0.4), 0.06));
  REQUIRE(seen.points().size() > 300);

  auto random = test::random_case(1);
  std::uniform_real_distribution<double> side(-0.013, 0.013), along(0.15, 0.85);
  int compared = 0;
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d x = finger.a + along(random) * (finger.b - finger.a) +
                       Vector3d(side(random), side(random), side(random));
    const double truth = finger.distance(x);
    const auto nearest = seen.nearest((body_from_camera * x).cast<float>());
    if (truth > 0.006) continue;
    REQUIRE(nearest.has_value());
    worst = std::max(worst, std::abs(static_cast<double>(nearest->distance) - truth));
    ++compared;
  }
  CHECK(compared > 1000);
  // Before, beside and behind it: the axis, where the balls' centres should be, is found to 1 mm.
  CHECK(worst < tolerance(0.0011, "normals fitted over 5 px of 1.1 mm on a radius of 8 mm"));
}

TEST_CASE("the grid finds what looking at every point finds", "[contact][seen surface][law]") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<float> where(-0.08f, 0.08f), wide(-0.14f, 0.14f);
    std::vector<SeenPoint> cloud;
    for (unsigned i = 0; i < 40 + 60 * seed; ++i) {
      const Vector3f y(where(random), where(random) * 0.5f, where(random) * 0.3f);
      const Vector3f n = Vector3f(where(random), where(random), where(random)).normalized();
      cloud.push_back({y, n, y - 0.008f * n, 0.4f});
    }
    SeenSurface seen;
    seen.build(cloud,
               Eigen::AlignedBox3d(Vector3d(-0.05, -0.03, -0.02), Vector3d(0.06, 0.02, 0.03)));
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vector3f x(wide(random), wide(random), wide(random));
      const auto fast = seen.nearest(x);
      const auto slow = seen.nearest_by_brute_force(x);
      REQUIRE(fast.has_value() == slow.has_value());
      if (!fast) continue;
      ++found;
      CHECK(fast->distance == slow->distance);
      CHECK(fast->support == slow->support);
    }
    CHECK(found > 50);
    CHECK(found < 2000);
  }
}

TEST_CASE("the whole body's region sees nothing that is far from it", "[contact][seen surface]") {
  const Capsule near{{0, 0, 0.4}, {0, 0, 0.4}, 0.02}, far{{0.1, 0, 0.6}, {0.1, 0, 0.6}, 0.02};
  const DepthImage depth = test::depth_of({near, far}, kCamera);
  SeenSurface seen;
  seen.build(depth, kCamera, Rigid3::Identity(), box_around({0, 0, 0.4}, 0.01));
  REQUIRE(!seen.points().empty());
  for (const SeenPoint& point : seen.points()) CHECK(point.point.z() < 0.45f);
}

TEST_CASE("pixels without depth, and single flickering ones, make no points",
          "[contact][seen surface]") {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr float kFar = std::numeric_limits<float>::infinity();
  DepthImage depth(kCamera.width, kCamera.height, kNone);
  depth(20, 20) = kFar;
  depth(30, 30) = 0.0f;
  depth(41, 41) = -0.4f;
  depth(61, 61) = 0.4f;  // alone
  SeenSurfaceSettings settings;
  settings.step = 1;
  SeenSurface seen(settings);
  const auto everywhere = box_around({0, 0, 0.4}, 0.5);
  seen.build(depth, kCamera, Rigid3::Identity(), everywhere);
  CHECK(seen.points().empty());
  CHECK_FALSE(seen.nearest(kCamera.unproject(61, 61, 0.4).cast<float>()).has_value());

  for (float& z : depth) z = 0.6f;
  depth(61, 61) = 0.4f;  // alone in front of a wall
  seen.build(depth, kCamera, Rigid3::Identity(), everywhere);
  REQUIRE(seen.points().size() > 1000);
  for (const SeenPoint& point : seen.points()) CHECK(point.depth == 0.6f);
}

TEST_CASE("the outermost pixels of a near thing before a far one are not believed",
          "[contact][seen surface]") {
  DepthImage depth(kCamera.width, kCamera.height, 0.6f);
  for (int v = 40; v < 80; ++v) {
    for (int u = 50; u < 90; ++u) depth(u, v) = 0.4f;
  }
  SeenSurfaceSettings settings;
  settings.step = 1;
  settings.normal_reach = 2;
  SeenSurface seen(settings);
  seen.build(depth, kCamera, Rigid3::Identity(), box_around({0, 0, 0.4}, 0.05));
  CHECK(seen.points().size() == 38 * 38);
}

TEST_CASE("a left margin drops what the matcher smears, up to 0.8 thicknesses",
          "[contact][seen surface]") {
  // A hand at 0.4 m over columns 50..89 before nothing: 14 px are a thickness of 16 mm.
  DepthImage depth(kCamera.width, kCamera.height, std::numeric_limits<float>::quiet_NaN());
  for (int v = 40; v < 80; ++v) {
    for (int u = 50; u < 90; ++u) depth(u, v) = 0.4f;
  }
  const auto leftmost = [&](int margin) {
    SeenSurfaceSettings settings;
    settings.step = 1;
    settings.normal_reach = 1;
    settings.left_margin = margin;
    SeenSurface seen(settings);
    seen.build(depth, kCamera, Rigid3::Identity(), box_around({0, 0, 0.4}, 0.05));
    double least = kCamera.width;
    for (const SeenPoint& point : seen.points()) {
      least = std::min(least, kCamera.project(point.point.cast<double>()).x());
    }
    return std::lround(least);
  };
  CHECK(leftmost(0) == 51);
  CHECK(leftmost(6) == 56);
  CHECK(leftmost(100) == 50 + 11);  // 0.8 * 14 px
}

TEST_CASE("building a second frame like the first and asking it allocates nothing",
          "[contact][frame loop]") {
  const DepthImage depth = test::depth_of({{{-0.05, 0, 0.4}, {0.05, 0, 0.4}, 0.01}}, kCamera);
  SeenSurface seen;
  const auto region = box_around({0, 0, 0.4}, 0.05);
  seen.build(depth, kCamera, Rigid3::Identity(), region);
  seen.build(depth, kCamera, Rigid3::Identity(), region);
  float distance = 0;
  CHECK(test::allocations_during([&] {
          seen.build(depth, kCamera, Rigid3::Identity(), region);
          distance = seen.nearest(Vector3f(0, 0, 0.395f))->distance;
        }) == 0);
  CHECK(distance < 0);
}

TEST_CASE("a camera of another size and impossible settings are refused", "[contact][errors]") {
  SeenSurface seen;
  CHECK_THROWS_AS(
      seen.build(DepthImage(10, 10), kCamera, Rigid3::Identity(), box_around({0, 0, 0}, 1)),
      ContractViolation);
  CHECK_THROWS_AS(seen.build(std::vector<SeenPoint>{}, Eigen::AlignedBox3d()), ContractViolation);
  CHECK_THROWS_AS(SeenSurface({.step = 0}), ContractViolation);
  CHECK_THROWS_AS(SeenSurface({.normal_reach = 0}), ContractViolation);
  CHECK_THROWS_AS(SeenSurface({.left_margin = -1}), ContractViolation);
  CHECK_THROWS_AS(SeenSurface({.thickness = 0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
