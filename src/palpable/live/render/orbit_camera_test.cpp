#include "palpable/live/render/orbit_camera.h"

#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/studio.h"
#include "tests/support/test.h"

#include <cmath>

using namespace palpable;

TEST_CASE("an orbiting camera looks at its target with the body's up pointing up", "[render]") {
  for (int i = 0; i < 24; ++i) {
    const OrbitCamera orbit{{0.1, -0.2, 0.07}, 0.3 * i, -0.4 + 0.08 * i, 0.5};
    INFO("azimuth " << orbit.azimuth << " elevation " << orbit.elevation);
    const Rigid3 camera_from_body = orbit.camera_from_body();
    const Eigen::Vector3d seen = camera_from_body * orbit.target;
    CHECK((seen - Eigen::Vector3d(0, 0, 0.5)).norm() < 1e-12);
    CHECK(camera_from_body.linear().determinant() == Approx(1.0));
    CHECK((camera_from_body.linear() * camera_from_body.linear().transpose() -
           Eigen::Matrix3d::Identity())
              .norm() < 1e-12);
    const Eigen::Vector3d up = camera_from_body.linear() * Eigen::Vector3d::UnitZ();
    CHECK(up.y() < 0);  // Y points down
    CHECK(std::abs(up.x()) < 1e-12);
  }
}

TEST_CASE("what is grabbed follows the mouse", "[render]") {
  OrbitCamera orbit{{0, 0, 0}, 0.4, 0.5, 1.0};
  const Eigen::Vector3d front = orbit.eye().normalized() * 0.1;
  const Eigen::Vector3d before = orbit.camera_from_body() * front;
  orbit.turn(10, 0);
  CHECK((orbit.camera_from_body() * front).x() > before.x());
  orbit.turn(-10, 10);
  CHECK((orbit.camera_from_body() * front).y() > before.y());
  orbit.turn(0, 1e6);
  CHECK(orbit.elevation == OrbitCamera::kSteepest);
  orbit.turn(0, -1e6);
  CHECK(orbit.elevation > 0);
  orbit.zoom(3, 1.0);
  CHECK(orbit.distance < 1.0);
  orbit.zoom(-1000, 1.0);
  CHECK(orbit.distance == 8.0);
}

TEST_CASE("the studio's floor is at the body's feet", "[render]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  Studio studio = value_or_throw(Studio::make());
  const PinholeCamera camera = camera_of_view(321, 241, 0.7);
  const OrbitCamera orbit{{0, 0, 0.02}, 0.3, 0.6, 0.4};
  const Rigid3 camera_from_body = orbit.camera_from_body();
  ColorImage picture;
  studio.draw(camera, camera_from_body, picture);
  REQUIRE(picture.width() == 321);
  const auto at = [&](double x, double y) {
    const Eigen::Vector2d p = camera.project(camera_from_body * Eigen::Vector3d(x, y, 0));
    return picture(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))).r;
  };
  // Lines of the 5 cm grid are darker than what lies half way between the fine ones.
  for (const double line : {-0.05, 0.0, 0.05}) {
    INFO("line " << line);
    CHECK(at(line, 0.024) + 8 < at(line + 0.005, 0.024));
    CHECK(at(0.026, line) + 8 < at(0.026, line + 0.005));
  }
  CHECK(context.value().errors().count() == 0);
}
