#include "palpable/live/view/scene_light.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstdint>
#include <limits>

namespace palpable {
namespace {

std::uint8_t byte_of(double linear) {
  return static_cast<std::uint8_t>(
      std::lround(255.0 * std::pow(std::clamp(linear, 0.0, 1.0), 1.0 / 2.2)));
}

// A matt ball before a wall, both lit by a lamp and by the room: I = albedo (room + max(0, n . l)).
SeenFrame lit_ball(const Eigen::Vector3d& to_light, double room, double gain = 1) {
  SeenFrame seen;
  seen.camera = {320, 180, 340, 340, 160, 90};
  seen.depth_camera = seen.camera;
  seen.color = ColorImage(320, 180);
  seen.depth = DepthImage(320, 180, 0.7f);
  const Eigen::Vector3d centre(0.02, -0.01, 0.5);
  const double radius = 0.1;
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 320; ++x) {
      const Eigen::Vector3d ray = seen.camera.unproject(x, y, 1.0);
      const double along = ray.dot(centre) / ray.squaredNorm();
      const double beside = (along * ray - centre).squaredNorm();
      Eigen::Vector3d normal(0, 0, -1);
      Eigen::Vector3d albedo(0.25, 0.32, 0.4);  // of the wall
      if (beside < radius * radius) {
        const double z = along - std::sqrt((radius * radius - beside) / ray.squaredNorm());
        seen.depth(x, y) = static_cast<float>(z);
        normal = (z * ray - centre) / radius;
        albedo = {0.5, 0.3, 0.2};
      }
      const double light = gain * (room + std::max(0.0, normal.dot(to_light)));
      seen.color(x, y) = {byte_of(light * albedo.x()), byte_of(light * albedo.y()),
                          byte_of(light * albedo.z())};
    }
  }
  return seen;
}

// Body frame: Z is up in the picture.
Rigid3 upright() {
  Rigid3 camera_from_body = Rigid3::Identity();
  camera_from_body.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return camera_from_body;
}

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180 / 3.14159265;
}

TEST_CASE("the light on a matt ball is found from wherever it comes", "[view][light]") {
  const Rigid3 camera_from_body = upright();
  for (const Eigen::Vector3d& to_light :
       {Eigen::Vector3d(-0.6, -0.5, -0.6), Eigen::Vector3d(0.7, -0.4, -0.6),
        Eigen::Vector3d(0.1, -0.9, -0.4)}) {
    LightEstimator estimator;
    estimator.see(lit_ball(to_light.normalized(), 0.4), camera_from_body);
    const Eigen::Vector3d found = camera_from_body.linear() * estimator.light().to_light;
    INFO(found.transpose());
    // In the dark, 8-bit pixels are coarse, and the prior pulls the light upwards.
    CHECK(degrees_between(found, to_light) < 10);
  }
}

TEST_CASE("light from everywhere is less directed than a lamp's", "[view][light]") {
  LightEstimator lamp, overcast;
  const Eigen::Vector3d to_light = Eigen::Vector3d(-0.6, -0.5, -0.6).normalized();
  lamp.see(lit_ball(to_light, 0.3, 0.7), upright());
  overcast.see(lit_ball(to_light, 3.0, 0.25), upright());
  CHECK(lamp.light().directed > 2 * overcast.light().directed);
}

TEST_CASE("a darker picture is darker light, and light follows slowly", "[view][light]") {
  LightEstimator estimator;
  const Eigen::Vector3d to_light = Eigen::Vector3d(-0.6, -0.5, -0.6).normalized();
  const SeenFrame bright = lit_ball(to_light, 0.4), dark = lit_ball(to_light, 0.4, 0.25);
  estimator.see(bright, upright());
  const double before = estimator.light().brightness;
  const auto see_times = [&](const SeenFrame& seen, int frames) {
    for (int i = 0; i < frames; ++i) estimator.see(seen, upright());
  };
  see_times(dark, LightEstimator::kEvery);  // the first dark frame is used
  CHECK(estimator.light().brightness < before);
  CHECK(estimator.light().brightness > 0.7 * before);
  see_times(dark, 40 * LightEstimator::kEvery);
  CHECK(estimator.light().brightness == Approx(0.25 * before).epsilon(0.05));
}

TEST_CASE("without any shading the light comes from the usual direction", "[view][light]") {
  SeenFrame seen = lit_ball(Eigen::Vector3d(-1, 0, 0), 0.4);
  std::fill(seen.depth.begin(), seen.depth.end(), std::numeric_limits<float>::quiet_NaN());
  LightEstimator estimator;
  estimator.see(seen, upright());
  const Rigid3 camera_from_body = upright();
  CHECK((camera_from_body.linear() * estimator.light().to_light)
            .isApprox(usual_lamp(camera_from_body.linear().col(2)), 1e-6));
  CHECK(estimator.light().directed == Approx(1.5));
}

TEST_CASE("light is followed without taking memory", "[view][light]") {
  LightEstimator estimator;
  const SeenFrame seen = lit_ball(Eigen::Vector3d(-0.6, -0.5, -0.6).normalized(), 0.4);
  estimator.see(seen, upright());
  CHECK(test::allocations_during([&] {
          for (int i = 0; i < 2 * LightEstimator::kEvery; ++i) estimator.see(seen, upright());
        }) == 0);
}

}  // namespace
}  // namespace palpable
