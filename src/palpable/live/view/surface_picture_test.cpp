#include "palpable/live/view/surface_picture.h"

#include "palpable/live/render/gl_context.h"
#include "palpable/live/session/frame_loop.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/seen_wall.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {
namespace {

bool is_green(Rgb c) { return c.g > c.r + 30 && c.g > c.b + 20; }
bool is_orange(Rgb c) { return c.r > c.b + 80 && c.r > c.g + 30; }

TEST_CASE("the side of a ball that the camera sees is green, its other side orange", "[view]") {
  const Eigen::Vector3f eye(0, 0, -0.4f);
  std::vector<ObjectBall> balls(2);
  balls[0].centre = {0, 0, 0};
  balls[0].radius = 0.01f;
  balls[1].centre = {0.1f, 0, 0};
  balls[1].radius = 0.02f;
  balls[1].unseen_for = 0.1f;
  BallMesh mesh;
  mesh_balls(balls, eye, mesh);
  const auto count = static_cast<Eigen::Index>(mesh.colors.size());
  REQUIRE(mesh.vertices.cols() == count);
  REQUIRE(mesh.normals.cols() == count);
  CHECK(mesh.triangles.maxCoeff() == count - 1);
  int green = 0, orange = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    const ObjectBall& ball = balls[k < count / 2 ? 0 : 1];
    CHECK((mesh.vertices.col(k) - ball.centre).norm() == Approx(ball.radius));
    const Rgb color = mesh.colors[static_cast<std::size_t>(k)];
    if (k >= count / 2) {
      CHECK_FALSE((is_green(color) || is_orange(color)));
      continue;
    }
    green += is_green(color) ? 1 : 0;
    orange += is_orange(color) ? 1 : 0;
    CHECK(is_green(color) == (mesh.vertices(2, k) < -2e-4f));  // as seen from 0.4 m
  }
  CHECK(green + orange == count / 2);
  CHECK(green > count / 5);
  mesh_balls({}, eye, mesh);
  CHECK(mesh.vertices.cols() == 0);
}

TEST_CASE("the surface's picture shows what presses, and turns with the mouse", "[view][pixels]") {
  const auto context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP("no OpenGL: " + context.problem().message);
  Rigid3 camera_from_body = Rigid3::Identity();
  camera_from_body.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // Z up in the picture
  camera_from_body.translation() = Eigen::Vector3d(0, 0.05, 0.4);
  FrameLoop loop =
      value_or_throw(FrameLoop::make(test::DentedSphere{}.body(), camera_from_body,
                                     test::wall_format(), {.press_static = true, .map = false}));
  Frame frame = test::frame_of_wall(0, 0);
  const auto show = [&] {
    // A finger across, 2 mm above the sphere.
    const std::vector<test::Capsule> finger{{{-0.04, -0.062, 0.4}, {0.04, -0.062, 0.4}, 0.01}};
    const DepthImage depth = test::depth_of(finger, test::wall_format().depth_camera);
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (!std::isnan(depth.data()[i])) frame.depth.data()[i] = depth.data()[i];
    }
    return loop.process(frame);
  };
  SurfacePicture view(value_or_throw(MapRenderer::make()), loop.session);
  const ColorImage inside(640, 480, Rgb{0, 0, 255});
  ColorImage before, turned, back;
  const Scene scene = show();
  view.draw(scene, loop.session, 1e4, ColorScale::kBlueYellow, inside, before);
  REQUIRE(before.width() == 640);
  REQUIRE(before.height() == 480);
  CHECK(std::count_if(before.begin(), before.end(), is_green) > 300);
  CHECK(std::count_if(before.begin(), before.end(), is_orange) > 50);
  CHECK(before(610, 30) == Rgb{0, 0, 255});
  view.handle({.kind = WindowEvent::Kind::kPress, .x_px = 300, .y_px = 200});
  view.handle({.kind = WindowEvent::Kind::kMove, .x_px = 420, .y_px = 200});
  view.handle({.kind = WindowEvent::Kind::kRelease, .x_px = 420, .y_px = 200});
  view.draw(scene, loop.session, 1e4, ColorScale::kBlueYellow, inside, turned);
  CHECK_FALSE(turned == before);
  view.handle({.kind = WindowEvent::Kind::kKey, .key = 'R'});
  view.draw(scene, loop.session, 1e4, ColorScale::kBlueYellow, inside, back);
  CHECK(back == before);
}

}  // namespace
}  // namespace palpable
