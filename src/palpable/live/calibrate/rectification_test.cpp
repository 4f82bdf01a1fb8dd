#include "palpable/live/calibrate/rectification.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace palpable {
namespace {

using Eye = Rectification::Eye;

// A rig like the ZED Mini of the shared data, with a few degrees more between its eyes. All numbers
// differ between x and y and between left and right, so that any confusion is detected.
StereoRig some_rig() {
  StereoRig rig;
  rig.left = {{320, 180, 175.0, 175.4, 162.6, 90.2}, {-0.174, 0.0278, -3e-4, -2e-4, 1e-3}};
  rig.right = {{320, 180, 174.6, 174.9, 157.7, 87.6}, {-0.176, 0.0291, 2e-4, 1.9e-4, 0}};
  const Eigen::Vector3d turn(0.02, 0.03, -0.015);
  rig.right_from_left.linear() =
      Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  rig.right_from_left.translation() << -0.063, 0.0012, -0.0008;
  return rig;
}

double row_of(const DistortedCamera& camera, const Eigen::Vector3d& x) {
  return camera.project(x).y();
}

TEST_CASE("a point lies on the same row of both rectified eyes, f T / Z apart",
          "[calibrate][rectification][Sec3.3]") {
  const StereoRig rig = some_rig();
  const RectifiedGeometry g = rectified_geometry(rig);
  const PinholeCamera& camera = g.stereo.camera;
  auto random = test::random_case(1);
  std::uniform_real_distribution<double> sideways(-0.3, 0.3);
  std::uniform_real_distribution<double> forward(0.2, 3.0);
  double largest_raw_difference = 0;
  for (int i = 0; i < 200; ++i) {
    const double Z = forward(random);
    const Eigen::Vector3d x_in_left(sideways(random) * Z, sideways(random) * Z, Z);
    const Eigen::Vector3d x_in_right = rig.right_from_left * x_in_left;
    const Eigen::Vector3d x_in_rectified = g.rectified_from_left * x_in_left;
    // The rectified right eye has the same axes and is at the other end of the baseline.
    const Eigen::Vector3d seen_from_right =
        g.rectified_from_right * x_in_right - Eigen::Vector3d(g.stereo.baseline, 0, 0);
    const Eigen::Vector2d left = camera.project(x_in_rectified);
    const Eigen::Vector2d right = camera.project(seen_from_right);
    CHECK(std::abs(left.y() - right.y()) <= test::tolerance(1e-9, "rounding, f = 175 px"));
    CHECK(std::abs(left.x() - right.x() - g.stereo.disparity_px(x_in_rectified.z())) <=
          test::tolerance(1e-9, "rounding of disparities up to 60 px"));
    largest_raw_difference =
        std::max(largest_raw_difference,
                 std::abs(row_of(rig.left, x_in_left) - row_of(rig.right, x_in_right)));
  }
  CHECK(largest_raw_difference > 5);  // px: there was something to rectify
  CHECK(std::abs(g.stereo.baseline - rig.right_from_left.translation().norm()) <=
        test::tolerance(1e-12, "the baseline is the distance of the eyes"));
  CHECK(g.stereo.disparity_at_infinity_px == 0);
  CHECK(camera.fx_px == camera.fy_px);
}

TEST_CASE("a rig that is rectified already is left alone", "[calibrate][rectification]") {
  StereoRig rig;
  rig.left.pinhole = rig.right.pinhole = {320, 180, 175, 175, 159.5, 89.5};
  rig.right_from_left.translation().x() = -0.063;
  const RectifiedGeometry g = rectified_geometry(rig);
  CHECK((g.rectified_from_left.linear() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <=
        test::tolerance(1e-12, "the identity, up to rounding"));
  CHECK(std::abs(g.stereo.baseline - 0.063) <= test::tolerance(1e-12, "rounding"));
  // alpha = 0 may zoom by the half pixel between OpenCV's border and the centre of the last pixel.
  CHECK(std::abs(g.stereo.camera.fx_px - 175) <= test::tolerance(1.2, "one pixel in the width"));
}

// The picture of a wall at infinity: its brightness is a function of the direction in the rectified
// frame, expressed as the pixel of the full-size rectified image.
double brightness(double u, double v) { return 128 + 60 * std::sin(u / 6) + 60 * std::sin(v / 5); }

// The same wall through the distorted lens: the ray of a raw pixel is found by Newton's method on
// project().
ColorImage raw_picture(const DistortedCamera& lens, const Rigid3& rectified_from_raw,
                       const PinholeCamera& rectified) {
  ColorImage image(lens.pinhole.width, lens.pinhole.height);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Eigen::Vector2d wanted(x, y);
      Eigen::Vector3d ray = lens.pinhole.unproject(x, y, 1.0);
      for (int step = 0; step < 20; ++step) {
        const Eigen::Vector2d miss = lens.project(ray) - wanted;
        if (miss.norm() < 1e-9) break;
        constexpr double h = 1e-6;
        Eigen::Matrix2d J;
        J.col(0) = (lens.project(ray + Eigen::Vector3d(h, 0, 0)) - wanted - miss) / h;
        J.col(1) = (lens.project(ray + Eigen::Vector3d(0, h, 0)) - wanted - miss) / h;
        ray.head<2>() -= J.inverse() * miss;
      }
      const Eigen::Vector2d p = rectified.project(rectified_from_raw.linear() * ray);
      const auto level = static_cast<std::uint8_t>(std::lround(brightness(p.x(), p.y())));
      image(x, y) = {level, level, level};
    }
  }
  return image;
}

TEST_CASE("images are warped to where the geometry says, in colour and in luma",
          "[calibrate][rectification][Sec3.3]") {
  const StereoRig rig = some_rig();
  Rectification rectification(rig);
  const RectifiedGeometry& g = rectification.geometry();
  const PinholeCamera& camera = g.stereo.camera;
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    INFO((eye == Eye::kLeft ? "left" : "right"));
    const ColorImage raw = eye == Eye::kLeft
                               ? raw_picture(rig.left, g.rectified_from_left, camera)
                               : raw_picture(rig.right, g.rectified_from_right, camera);
    ColorImage color;
    GrayImage luma;
    rectification.rectify(eye, raw, color);
    rectification.rectify_luma(eye, raw, luma);
    REQUIRE((color.width() == 320 && color.height() == 180));
    double worst = 0;
    double worst_luma = 0;
    for (int y = 0; y < 180; ++y) {
      for (int x = 0; x < 320; ++x) {
        worst = std::max(worst, std::abs(color(x, y).g - brightness(x, y)));
        worst_luma = std::max(worst_luma, std::abs(luma(x, y) - brightness(x, y)));
      }
    }
    // The brightness changes by up to 22 grey levels per pixel.
    CHECK(worst <= test::tolerance(2.5,
                                   "tables of 1/32 px: 0.35; linear interpolation: 0.6; two "
                                   "roundings to bytes: 1; half a pixel off gives 11"));
    CHECK(worst_luma <= test::tolerance(3.0, "the same and the rounding to luma"));
  }
}

TEST_CASE("images that are rectified already are passed on, their luma halved",
          "[calibrate][rectification]") {
  // An odd size: the last column and row have no partner.
  Rectification rectification(RectifiedStereo{{7, 5, 100, 100, 3, 2}, 0.1, -3});
  ColorImage image(7, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      const auto level = static_cast<std::uint8_t>(10 * x + 40 * y);
      image(x, y) = {level, level, level};
    }
  }
  ColorImage color;
  GrayImage luma, half;
  rectification.rectify(Eye::kRight, image, color);
  rectification.rectify_luma(Eye::kRight, image, luma);
  Rectification::halve(luma, half);
  CHECK(color == image);
  REQUIRE((half.width() == 3 && half.height() == 2));
  CHECK(half(0, 0) == 25);
  CHECK(half(2, 1) == 25 + 40 + 80);
  CHECK(rectification.geometry().stereo.disparity_at_infinity_px == -3);
  CHECK(rectification.geometry().rectified_from_right.translation().x() == 0.1);
}

TEST_CASE("a rig that cannot be rectified is a problem with a reason",
          "[calibrate][rectification][refusal]") {
  StereoRig mirrored = some_rig();
  mirrored.right_from_left.translation() *= -1;
  const auto swapped = rectify_rig(mirrored);
  REQUIRE_FALSE(swapped.ok());
  CHECK(swapped.problem().message.find("swap") != std::string::npos);
  CHECK_THROWS_AS(rectified_geometry(mirrored), ContractViolation);
  CHECK_THROWS_AS(Rectification(mirrored), ContractViolation);

  // With k1 < 0, 1 + 3 k1 r^2 becomes negative inside the picture; with k1 > 0, no part without
  // blank pixels is left.
  for (const double k1 : {-0.5, -1.0, -50.0, 5.0, 1000.0}) {
    INFO("k1 = " << k1);
    StereoRig folded = some_rig();
    folded.left.distortion = {k1, 0, 0, 0, 0};
    const auto result = rectify_rig(folded);
    REQUIRE_FALSE(result.ok());
    CHECK(result.problem().message.find("distortion") != std::string::npos);
  }
  StereoRig apart = some_rig();
  apart.right_from_left.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()).matrix();
  apart.right_from_left.translation() =
      apart.right_from_left.linear() * Eigen::Vector3d(-0.063, 0, 0);
  const auto squint = rectify_rig(apart);
  REQUIRE_FALSE(squint.ok());
  CHECK(squint.problem().message.find("57 degrees") != std::string::npos);

  ColorImage wrong_size(10, 10);
  ColorImage out;
  CHECK_THROWS_AS(Rectification(some_rig()).rectify(Eye::kLeft, wrong_size, out),
                  ContractViolation);
}

TEST_CASE("rectifying takes no memory after the first time", "[calibrate][rectification]") {
  Rectification rectification(some_rig());
  const ColorImage raw(320, 180, Rgb{10, 20, 30});
  ColorImage color;
  GrayImage luma, half;
  const auto work = [&] {
    rectification.rectify(Eye::kLeft, raw, color);
    rectification.rectify_luma(Eye::kLeft, raw, luma);
    Rectification::halve(luma, half);
  };
  work();
  CHECK(test::allocations_during(work) == 0);
}

}  // namespace
}  // namespace palpable
