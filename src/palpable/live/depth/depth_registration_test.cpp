#include "palpable/live/depth/depth_registration.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/depth/depth_gaps.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

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

// A camera of the same view with other pixels, as in a phone: s times as many in each direction.
ColorSensor finer_view(const PinholeCamera& camera, int s) {
  const auto centre = [s](double c) { return s * (c + 0.5) - 0.5; };  // (0, 0): a pixel's centre
  return {{s * camera.width, s * camera.height, s * camera.fx_px, s * camera.fy_px,
           centre(camera.cx_px), centre(camera.cy_px)},
          Rigid3::Identity()};
}

// A slanted plane with a share of its pixels missing at random.
DepthImage plane_with_holes(const PinholeCamera& camera, const Eigen::Vector3d& n, double missing,
                            unsigned seed) {
  DepthImage depth(camera.width, camera.height);
  std::mt19937 random(seed);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const bool hole = static_cast<double>(random()) < missing * 4294967296.0;
      depth(x, y) = hole ? std::nanf("") : static_cast<float>(plane_depth(camera, n, x, y));
    }
  }
  return depth;
}

TEST_CASE("thin depth keeps as many pixels as were measured, and they are the surface's",
          "[depth][registration]") {
  const Eigen::Vector3d n(-0.5, 0.3, 1.1);
  const std::vector<ColorSensor> sensors{
      beside(), finer_view(kDepth, 3), {kDepth, Rigid3::Identity()}};
  for (const double missing : {0.1, 0.3, 0.5}) {
    for (const ColorSensor& color : sensors) {
      INFO("missing " << missing << ", colour " << color.camera.width << " px wide");
      const Eigen::Vector3d n_color = moved_plane(color.color_from_depth, n);
      DepthRegistration registration(kDepth, color);
      DepthImage whole, thin;
      registration.to_color(plane_with_holes(kDepth, n, 0, 1), whole);
      registration.to_color(plane_with_holes(kDepth, n, missing, 1), thin);
      int pixels = 0, filled = 0;
      double worst = 0;
      for (int v = 0; v < whole.height(); ++v) {
        for (int u = 0; u < whole.width(); ++u) {
          if (std::isnan(whole(u, v))) {
            REQUIRE(std::isnan(thin(u, v)));
            continue;
          }
          ++pixels;
          if (std::isnan(thin(u, v))) continue;
          ++filled;
          const double Z = plane_depth(color.camera, n_color, u, v);
          worst = std::max(worst, std::abs(static_cast<double>(thin(u, v)) / Z - 1));
        }
      }
      const double share = static_cast<double>(filled) / pixels;
      // The share that was measured: no depth is made up. Less where a corner was not bridged,
      // which takes both sides of all four lines: 0.01 of the pixels at 0.5.
      CHECK(share == Approx(1 - missing).margin(0.03));  // of 10,800 random pixels, and the border
      CHECK(worst <= tolerance(1e-5, "floats, their errors divided by a pixel's small area"));
    }
  }
}

TEST_CASE("holes are never bridged across an edge of depth", "[depth][registration]") {
  // A square at 0.8 m in front of a wall at 2 m; both have holes. Whoever interpolates across the
  // square's border gets a depth between the two, which no surface has.
  const PinholeCamera camera{80, 60, 90, 90, 39.5, 29.5};
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    DepthImage depth = plane_with_holes(camera, {0, 0, 0.5}, 0.3, seed);
    for (int y = 20; y < 40; ++y) {
      for (int x = 30; x < 50; ++x) {
        if (depth(x, y) > 0) depth(x, y) = 0.8F;
      }
    }
    DepthImage found;
    const ColorSensor color = finer_view(camera, 2);
    DepthRegistration(camera, color).to_color(depth, found);
    int near_pixels = 0, far_pixels = 0;
    for (int v = 0; v < found.height(); ++v) {
      for (int u = 0; u < found.width(); ++u) {
        const float Z = found(u, v);
        if (std::isnan(Z)) continue;
        const bool near_one = std::abs(Z - 0.8F) < 1e-5F;
        ++(near_one ? near_pixels : far_pixels);
        REQUIRE((near_one || std::abs(Z - 2.0F) < 1e-5F));
        // Half a depth pixel beyond the square at most, which is a pixel of this image.
        if (near_one)
          REQUIRE((u >= 59 && u <= 100 && v >= 39 && v <= 80));
        else
          REQUIRE_FALSE((u >= 61 && u <= 98 && v >= 41 && v <= 78));
      }
    }
    CHECK(near_pixels > 800);  // of 1600, a third of which are unknown,
    CHECK(far_pixels > 8000);  // and of 17,600
  }
}

TEST_CASE("a gap is bridged from both of its sides, and stays open where they are two surfaces",
          "[depth][registration]") {
  const float kNaN = std::nanf("");
  DepthImage depth(9, 9, 2.0F), bridged;
  depth(4, 4) = kNaN;
  bridge_gaps(depth, bridged);
  CHECK(bridged(4, 4) == 2.0F);
  CHECK(bridged(3, 4) == 2.0F);
  // In its row the hole lies halfway between depths of 2.0 m and 2.1 m; 1/Z is interpolated. No
  // other line through it has a depth on both sides.
  std::fill(depth.begin(), depth.end(), kNaN);
  depth(3, 4) = 2.0F;
  depth(5, 4) = 2.1F;
  bridge_gaps(depth, bridged);
  CHECK(bridged(4, 4) == Approx(2 / (1 / 2.0 + 1 / 2.1)).epsilon(1e-6));
  CHECK(std::isnan(bridged(6, 4)));  // one side only
  // The hole lies a third of the way from 2.0 m to 2.1 m.
  depth(5, 4) = kNaN;
  depth(6, 4) = 2.1F;
  bridge_gaps(depth, bridged);
  CHECK(bridged(4, 4) == Approx(3 / (2 / 2.0 + 1 / 2.1)).epsilon(1e-6));
  // Two surfaces: along the line, or one line against another.
  depth(6, 4) = 2.2F;
  bridge_gaps(depth, bridged);
  CHECK(std::isnan(bridged(4, 4)));
  depth(6, 4) = 2.0F;
  depth(4, 3) = depth(4, 5) = 1.0F;
  bridge_gaps(depth, bridged);
  CHECK(std::isnan(bridged(4, 4)));
}

TEST_CASE("depth of a phone, of fewer pixels than its colour, is measured in the colour's view",
          "[depth][registration]") {
  const Eigen::Vector3d n(-0.3, 0.2, 1.2);
  const ColorSensor color = finer_view(kDepth, 5);
  FrameFormat format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.width = color.camera.width;
  format.height = color.camera.height;
  format.depth_camera = kDepth;
  CHECK(DepthCamera::make(format, {}).problem().message.find("should be described") !=
        std::string::npos);
  format.color_sensor = color;
  DepthCamera camera = value_or_throw(DepthCamera::make(format, {}));
  Frame frame;
  frame.left = ColorImage(format.width, format.height, Rgb{90, 90, 90});
  frame.depth = plane_with_holes(kDepth, n, 0, 1);
  SeenFrame seen;
  camera.see(frame, seen);
  REQUIRE(seen.depth.width() == 5 * kDepth.width);
  CHECK(seen.density > 0.97);  // all but half a depth pixel at the borders
  CHECK(seen.depth(300, 200) == Approx(plane_depth(seen.depth_camera, n, 300, 200)).epsilon(1e-5));
  // Depth of the colour's size is not what the format says.
  frame.depth = DepthImage(format.width, format.height, 1.0F);
  camera.see(frame, seen);
  CHECK(seen.density == 0);
}

TEST_CASE("registration takes memory in its first call only, and refuses another size",
          "[depth][registration]") {
  DepthRegistration registration(kDepth, beside());
  DepthImage depth(kDepth.width, kDepth.height, 1.0F), found;
  registration.to_color(depth, found);
  depth(7, 7) = depth(8, 20) = std::nanf("");
  CHECK(test::allocations_during([&] { registration.to_color(depth, found); }) == 0);
  DepthImage other(kDepth.width - 1, kDepth.height, 1.0F);
  CHECK_THROWS_AS(registration.to_color(other, found), ContractViolation);
}

}  // namespace
}  // namespace palpable
