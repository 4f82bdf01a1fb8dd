#include "palpable/desk/script/seen_share.h"

#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/test.h"

#include <numbers>

using namespace palpable;
using palpable::test::tolerance;

namespace {

const RectifiedStereo kEyes{{640, 360, 350, 350, 319.5, 179.5}, 0.063};

// A ball of 40 mm radius in front of the camera, its centre 0.4 m away.
const Rigid3 kCameraFromBody = Rigid3(Eigen::Translation3d(0, 0, 0.4));

double share(const std::vector<Capsule>& in_body, const Rigid3& camera_from_body) {
  const SurfaceDistance ball(sphere_surface({0, 0, 0}, 0.04, 4));
  const Eigen::Matrix3Xd part = touching_part(in_body, ball, 0.0015, 500);
  return seen_share(camera_from_body * part, transformed(in_body, camera_from_body), kEyes);
}

}  // namespace

TEST_CASE("the touching part is the part of the surface inside the body", "[script]") {
  const SurfaceDistance ball(sphere_surface({0, 0, 0}, 0.04, 5));
  const double radius = 0.008, spacing = 0.0005;
  // A finger along X with the centre of its tip on the ball: about half of the tip's sphere is
  // inside, less because of the ball's curvature.
  const std::vector<Capsule> finger = {{{0.04, 0, 0}, {0.14, 0, 0}, radius, radius}};
  const Eigen::Matrix3Xd part = touching_part(finger, ball, spacing, 100'000);
  REQUIRE(part.cols() > 100);
  for (Eigen::Index i = 0; i < part.cols(); ++i) {
    CHECK(std::abs(signed_distance(finger, part.col(i))) <=
          tolerance(1e-12, "rounding of points built on the surface"));
    CHECK(part.col(i).norm() < 0.04);
  }
  // The two spheres intersect in the plane x = (2 R^2 - r^2) / (2 R). The cap of the finger's
  // sphere on the inner side of this plane touches.
  const double height = (2 * 0.04 * 0.04 - radius * radius) / (2 * 0.04) - (0.04 - radius);
  const double area = 2 * std::numbers::pi * radius * height;
  CHECK(static_cast<double>(part.cols()) * spacing * spacing ==
        Approx(area).epsilon(tolerance(0.1, "rings are closed with a whole number of points")));
  CHECK(touching_part(finger, ball, spacing, 60).cols() == 60);
}

TEST_CASE("conical capsules and spheres are covered by points, too", "[script]") {
  const SurfaceDistance ball(sphere_surface({0, 0, 0}, 0.04, 4));
  const auto all = [&](const Capsule& c) { return touching_part({&c, 1}, ball, 0.001, 100'000); };
  // These capsules are completely inside, so the area is that of the whole surface.
  const Capsule sphere{{0, 0, 0}, {0, 0, 0}, 0.01, 0.01};
  const Capsule swallowed{{0, 0, 0}, {0.002, 0, 0}, 0.01, 0.005};
  const double of_sphere = 4 * std::numbers::pi * 1e-4;
  CHECK(static_cast<double>(all(sphere).cols()) * 1e-6 == Approx(of_sphere).epsilon(0.1));
  CHECK(static_cast<double>(all(swallowed).cols()) * 1e-6 == Approx(of_sphere).epsilon(0.1));
  const Capsule straight{{-0.01, 0, 0}, {0.01, 0, 0}, 0.005, 0.005};
  CHECK(static_cast<double>(all(straight).cols()) * 1e-6 ==
        Approx(4 * std::numbers::pi * 25e-6 + 2 * std::numbers::pi * 0.005 * 0.02).epsilon(0.1));
  const Capsule cone{{-0.01, 0, 0}, {0.01, 0, 0}, 0.008, 0.002};
  const Eigen::Matrix3Xd points = all(cone);
  double farthest = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    farthest = std::max(farthest, std::abs(signed_distance(cone, points.col(i))));
  CHECK(farthest <= tolerance(1e-12, "rounding of points built on the surface"));
  CHECK(points.cols() > 500);
}

TEST_CASE("a camera sees a finger's side, not what is behind it or outside the picture",
          "[script]") {
  // A finger from the right, across the view: half of the tip faces the camera.
  const std::vector<Capsule> across = {{{0.035, 0, 0}, {0.14, 0, 0}, 0.008, 0.008}};
  const double side = share(across, kCameraFromBody);
  CHECK(side > 0.4);
  CHECK(side < 0.75);
  // Outside the picture nothing is seen.
  CHECK(share(across, Rigid3(Eigen::Translation3d(1.0, 0, 0.4))) == 0);
  // A plate of capsules nearer to the camera hides everything.
  std::vector<Capsule> covered = across;
  for (int i = -12; i <= 12; ++i)
    covered.push_back({{-0.1, 0.008 * i, -0.15}, {0.1, 0.008 * i, -0.15}, 0.006, 0.006});
  CHECK(share(covered, kCameraFromBody) == 0);
  // A finger from behind the body towards the camera: the end of the tip is seen.
  const std::vector<Capsule> from_behind = {{{0, 0, 0.04}, {0, 0, 0.14}, 0.008, 0.008}};
  CHECK(share(from_behind, kCameraFromBody) > 0.9);
  CHECK(share({}, kCameraFromBody) == 0);
}

TEST_CASE("a part that only the right eye sees counts as seen", "[script]") {
  // A bar near the left eye hides the finger from this eye only.
  std::vector<Capsule> finger = {{{0.035, 0, 0}, {0.14, 0, 0}, 0.008, 0.008}};
  const double open = share(finger, kCameraFromBody);
  finger.push_back({{0, -0.1, -0.35}, {0, 0.1, -0.35}, 0.02, 0.02});
  const double one_eye = share(finger, kCameraFromBody);
  CHECK(one_eye > 0.6 * open);
  finger.push_back({{0.055, -0.1, -0.35}, {0.055, 0.1, -0.35}, 0.02, 0.02});
  CHECK(share(finger, kCameraFromBody) < 0.1 * open);
}
