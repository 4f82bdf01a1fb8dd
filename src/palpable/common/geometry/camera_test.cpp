#include "palpable/common/geometry/camera.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::tolerance;

constexpr PinholeCamera kCamera{1280, 720, 700.0, 702.0, 641.5, 355.25};

TEST_CASE("unprojecting undoes projecting", "[geometry]") {
  for (unsigned seed = 0; seed < 25; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> side(-0.4, 0.4), depth(0.1, 15.0);
    const double Z = depth(random);
    const Vector3d x(side(random) * Z, side(random) * Z, Z);
    const Vector2d pixel = kCamera.project(x);
    CHECK((kCamera.unproject(pixel.x(), pixel.y(), Z) - x).norm() <=
          tolerance(1e-14, "a few roundings") * Z);
  }
}

TEST_CASE("a pixel of the halved camera sees the centre of its four pixels", "[geometry]") {
  const PinholeCamera half = kCamera.scaled_down(2);
  CHECK(half.width == 640);
  CHECK(half.height == 360);
  const Vector3d x = half.unproject(10, 20, 0.5);
  const Vector2d pixel = kCamera.project(x);
  // Pixels 20 and 21, 40 and 41: their middle lies half a pixel beyond the first.
  CHECK((pixel - Vector2d(20.5, 40.5)).norm() <= tolerance(1e-12, "a few roundings of 1000"));
}

TEST_CASE("without coefficients a lens is a pinhole", "[geometry]") {
  const DistortedCamera camera{kCamera, {}};
  const Vector3d x(0.1, -0.2, 0.7);
  CHECK((camera.project(x) - kCamera.project(x)).norm() <=
        tolerance(1e-12, "roundings of 1000 in another order"));
}

TEST_CASE("radial distortion moves a point along its radius by the polynomial", "[geometry]") {
  const DistortedCamera camera{kCamera, {-0.17, 0.02, 0.0, 0.0, 0.005}};
  const double x = 0.3, y = -0.4, r2 = 0.25;  // 3-4-5 triangle: exact squares
  const double factor = 1.0 - 0.17 * r2 + 0.02 * r2 * r2 + 0.005 * r2 * r2 * r2;
  const Vector2d expected(700.0 * x * factor + 641.5, 702.0 * y * factor + 355.25);
  CHECK((camera.project({x, y, 1.0}) - expected).norm() <= tolerance(1e-12, "roundings of 1000"));
}

TEST_CASE("tangential distortion has the two terms of Brown and Conrady", "[geometry]") {
  const DistortedCamera camera{kCamera, {0.0, 0.0, 1e-3, 2e-3, 0.0}};
  const double x = 0.3, y = -0.4, r2 = 0.25;
  const double dx = 2.0 * 1e-3 * x * y + 2e-3 * (r2 + 2.0 * x * x);
  const double dy = 1e-3 * (r2 + 2.0 * y * y) + 2.0 * 2e-3 * x * y;
  const Vector2d expected(700.0 * (x + dx) + 641.5, 702.0 * (y + dy) + 355.25);
  CHECK((camera.project({2 * x, 2 * y, 2.0}) - expected).norm() <=
        tolerance(1e-12, "roundings of 1000"));
}

TEST_CASE("depth and disparity are inverse, infinity included", "[geometry]") {
  const RectifiedStereo stereo{kCamera, 0.063, 31.086};
  CHECK(stereo.depth(stereo.disparity_px(0.3)) ==
        Approx(0.3).epsilon(tolerance(1e-13, "roundings")));
  CHECK(stereo.depth(147.0 + 31.086) == Approx(700.0 * 0.063 / 147.0).epsilon(1e-13));
  CHECK(std::isinf(stereo.depth(31.086)));
}

}  // namespace
}  // namespace palpable
