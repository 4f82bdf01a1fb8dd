#include "palpable/live/depth/depth_registration.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cmath>

namespace palpable {
namespace {

using test::tolerance;

// Two sensors like those of a Kinect, with different sizes and focal lengths, 40 mm apart and
// turned.
const PinholeCamera kDepth{120, 90, 110, 112, 58, 46};
ColorSensor beside() {
  ColorSensor color{{100, 80, 95, 93, 52, 37}, Rigid3::Identity()};
  color.color_from_depth.translation() << -0.04, 0.003, 0.01;
  color.color_from_depth.linear() =
      Eigen::AngleAxisd(0.03, Eigen::Vector3d(0.4, -1, 0.5).normalized()).toRotationMatrix();
  return color;
}

// Z of the plane n x = 1 on the ray of a pixel; the plane in the camera's frame.
double plane_depth(const PinholeCamera& camera, const Eigen::Vector3d& n, double u, double v) {
  return 1 / n.dot(camera.unproject(u, v, 1));
}

// The same plane in another frame: n x = 1 with x = T^-1 y.
Eigen::Vector3d moved_plane(const Rigid3& T, const Eigen::Vector3d& n) {
  const Eigen::Vector3d turned = T.linear() * n;
  return turned / (1 + turned.dot(T.translation()));
}

TEST_CASE("a plane's depth in the colour view is the plane's, without holes",
          "[depth][registration]") {
  const ColorSensor color = beside();
  const Rigid3 depth_from_color = color.color_from_depth.inverse();
  DepthRegistration registration(kDepth, color);
  // A frontal plane, then a slanted one that appears larger to the colour camera, with more pixels
  // than were measured.
  for (const Eigen::Vector3d& n :
       {Eigen::Vector3d(0, 0, 1.25), Eigen::Vector3d(-1.1, 0.4, 1.1), Eigen::Vector3d(0, 1.2, 1)}) {
    INFO("plane " << n.transpose());
    const Eigen::Vector3d n_color = moved_plane(color.color_from_depth, n);
    DepthImage depth(kDepth.width, kDepth.height);
    for (int y = 0; y < kDepth.height; ++y) {
      for (int x = 0; x < kDepth.width; ++x) {
        depth(x, y) = static_cast<float>(plane_depth(kDepth, n, x, y));
      }
    }
    DepthImage found;
    registration.to_color(depth, found);
    REQUIRE(found.width() == color.camera.width);
    REQUIRE(found.height() == color.camera.height);
    int inside = 0;
    double worst = 0;
    for (int v = 0; v < found.height(); ++v) {
      for (int u = 0; u < found.width(); ++u) {
        const double Z = plane_depth(color.camera, n_color, u, v);
        const Eigen::Vector3d x = depth_from_color * color.camera.unproject(u, v, Z);
        const Eigen::Vector2d at = kDepth.project(x);
        const double border =
            std::min({at.x(), at.y(), kDepth.width - 1 - at.x(), kDepth.height - 1 - at.y()});
        INFO("u " << u << " v " << v << " border " << border);
        if (border > 0.01) {
          ++inside;
          REQUIRE_FALSE(std::isnan(found(u, v)));
          worst = std::max(worst, std::abs(static_cast<double>(found(u, v)) / Z - 1));
        } else if (border < -0.01) {
          REQUIRE(std::isnan(found(u, v)));
        }
      }
    }
    CHECK(inside > 4000);
    CHECK(worst <= tolerance(1e-5, "floats, their errors divided by a pixel's small area"));
  }
}

TEST_CASE(
    "what stands before something hides it in the colour view; what the depth did not see "
    "is unknown",
    "[depth][registration]") {
  // The colour camera is 50 mm to the right with the same focal length: points at 0.5 m move by
  // 10 px to the left, points at 2 m by 2.5 px.
  const PinholeCamera camera{100, 20, 100, 100, 49.5, 9.5};
  ColorSensor color{camera, Rigid3::Identity()};
  color.color_from_depth.translation() << -0.05, 0, 0;
  DepthRegistration registration(camera, color);
  DepthImage depth(100, 20, 2.0F), found;
  for (int y = 0; y < 20; ++y) {
    for (int x = 40; x < 60; ++x) depth(x, y) = 0.5F;
  }
  registration.to_color(depth, found);
  for (int u = 0; u < 97; ++u) {
    INFO("u " << u);
    // Near: 40..59 -> 30..49. Far: up to 39 -> 36.5, hidden from 30 on; from 60 -> 57.5 on.
    if (u < 30) CHECK(found(u, 10) == 2.0F);
    if (u >= 30 && u <= 49) CHECK(found(u, 10) == Approx(0.5F).epsilon(1e-5));
    if (u > 49 && u < 58) CHECK(std::isnan(found(u, 10)));
    if (u >= 58) CHECK(found(u, 10) == 2.0F);
  }
}

TEST_CASE("unknown depths stay unknown and one by itself is left out", "[depth][registration]") {
  const PinholeCamera camera{30, 20, 40, 40, 14.5, 9.5};
  DepthRegistration registration(camera, {camera, Rigid3::Identity()});
  const float kNaN = std::nanf("");
  DepthImage depth(30, 20, 1.5F), found;
  depth(7, 5) = kNaN;
  registration.to_color(depth, found);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 30; ++x) CHECK(std::isnan(found(x, y)) == (x == 7 && y == 5));
  }
  std::fill(depth.begin(), depth.end(), kNaN);
  depth(7, 5) = 1.5F;
  depth(12, 12) = -1.0F;
  registration.to_color(depth, found);
  for (const float Z : found) CHECK(std::isnan(Z));
  // Behind the colour camera: not visible.
  ColorSensor before{camera, Rigid3::Identity()};
  before.color_from_depth.translation() << 0, 0, -2;
  std::fill(depth.begin(), depth.end(), 1.5F);
  DepthRegistration(camera, before).to_color(depth, found);
  for (const float Z : found) CHECK(std::isnan(Z));
}

TEST_CASE("registration takes memory in its first call only, and refuses another size",
          "[depth][registration]") {
  DepthRegistration registration(kDepth, beside());
  DepthImage depth(kDepth.width, kDepth.height, 1.0F), found;
  registration.to_color(depth, found);
  CHECK(test::allocations_during([&] { registration.to_color(depth, found); }) == 0);
  DepthImage other(kDepth.width - 1, kDepth.height, 1.0F);
  CHECK_THROWS_AS(registration.to_color(other, found), ContractViolation);
}

}  // namespace
}  // namespace palpable
