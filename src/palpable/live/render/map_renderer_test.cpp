#include "palpable/live/render/map_renderer.h"

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/render/gl_context.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

using namespace palpable;
using palpable::test::tolerance;

namespace {

/// Off-centre principal point, unequal focal lengths, odd size, so that no errors cancel by
/// symmetry.
const PinholeCamera kCamera{322, 241, 410.0, 395.0, 171.3, 108.6};
constexpr Rgb kBlue{20, 60, 220};

/// The context and the renderer of one test; skips the test where there is no context.
struct Renderer {
  Result<GlContext> context = GlContext::offscreen();
  std::unique_ptr<MapRenderer> renderer;
  bool ready() {
    if (!context.ok()) return false;
    renderer = std::make_unique<MapRenderer>(value_or_throw(MapRenderer::make()));
    return true;
  }
  ~Renderer() {
    if (context.ok()) {
      INFO(context.value().errors().first());
      CHECK(context.value().errors().count() == 0);
    }
  }
};

/// A wall at depth Z (m) that covers the pixels u0 .. u1 (edges half way between centres) of all
/// rows, red above row 100 and green below it; its front faces the camera or away from it.
struct Wall {
  Wall(double Z, double u0, double u1, bool to_camera = true) {
    vertices.resize(3, 8);
    normals.resize(3, 8);
    for (int i = 0; i < 8; ++i) {
      const double v = i < 2 ? -1 : i < 6 ? 99.5 : 242;
      vertices.col(i) = kCamera.unproject(i % 2 == 0 ? u0 : u1, v, Z).cast<float>();
      normals.col(i) = Eigen::Vector3f(0, 0, to_camera ? -1.0f : 1.0f);
      colors[i] = i < 4 ? Rgb{200, 0, 0} : Rgb{0, 200, 0};
    }
    // Counter-clockwise as seen by the eye, in a picture whose Y points down.
    triangles.resize(3, 4);
    triangles << 0, 1, 4, 5, 2, 2, 6, 6, 1, 3, 5, 7;
    if (!to_camera) triangles.row(1).swap(triangles.row(2));
  }
  [[nodiscard]] MapSurface surface() const { return {&vertices, &normals, &triangles, colors}; }
  Eigen::Matrix3Xf vertices, normals;
  Eigen::Matrix3Xi triangles;
  std::array<Rgb, 8> colors;
};

bool is_near(Rgb a, Rgb b, int margin) {
  return std::abs(a.r - b.r) <= margin && std::abs(a.g - b.g) <= margin &&
         std::abs(a.b - b.b) <= margin;
}
bool reddish(Rgb c) { return c.r > 100 && c.g < 30 && c.b < 30; }
bool greenish(Rgb c) { return c.g > 100 && c.r < 30 && c.b < 30; }

}  // namespace

#define PALPABLE_NEEDS_RENDERER(name) \
  Renderer name;                      \
  if (!name.ready()) PALPABLE_SKIP(name.context.problem().message)

TEST_CASE("the surface of the map stands in the picture in its colours", "[render][map]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Wall wall(0.8, 99.5, 219.5);
  gl.renderer->set_surface(wall.surface());
  ColorImage picture;
  gl.renderer->draw({.camera = kCamera}, picture);
  REQUIRE(picture.width() == kCamera.width);
  REQUIRE(picture.height() == kCamera.height);
  const Rgb empty = picture(5, 5);
  int wrong = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const bool on = x >= 100 && x <= 219;
      const Rgb c = picture(x, y);
      wrong += (on ? (y < 100 ? reddish(c) : greenish(c)) : c == empty) ? 0 : 1;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a wall that is seen from behind is left out", "[render][map]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Wall wall(0.8, 99.5, 219.5, false);
  gl.renderer->set_surface(wall.surface());
  ColorImage picture;
  gl.renderer->draw({.camera = kCamera}, picture);
  CHECK(std::all_of(picture.begin(), picture.end(), [&](Rgb c) { return c == picture(0, 0); }));
}

TEST_CASE("a line is where its ends are projected to, as wide as it says, and faint behind a wall",
          "[render][map]") {
  PALPABLE_NEEDS_RENDERER(gl);
  // The world frame is rotated and translated relative to the view.
  const Rigid3 camera_from_world =
      Eigen::Translation3d(0.2, -0.1, 0.3) *
      Rigid3(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  const Rigid3 world_from_camera = camera_from_world.inverse();
  const auto world = [&](double u, double v, double Z) -> Eigen::Vector3f {
    return (world_from_camera * kCamera.unproject(u, v, Z)).cast<float>();
  };
  Wall wall(0.8, 99.5, 219.5);
  const Eigen::Isometry3f moved = world_from_camera.cast<float>();
  wall.vertices = ((moved.linear() * wall.vertices).colwise() + moved.translation()).eval();
  gl.renderer->set_surface(wall.surface());
  // A line 5 px wide along row 150, from 2 m to 0.5 m, so that it passes through the wall.
  const std::array lines{MapLine{world(40, 150, 2), world(280, 150, 0.5), kBlue, 5}};
  ColorImage picture;
  gl.renderer->draw({.camera = kCamera, .camera_from_world = camera_from_world, .lines = lines},
                    picture);
  const auto column = [&](int u) {
    int blue = 0;
    for (int v = 0; v < kCamera.height; ++v) blue += picture(u, v) == kBlue ? 1 : 0;
    return blue;
  };
  // 1/Z is linear in u: the wall's 0.8 m are crossed at u = 40 + 240 (1/0.8 - 1/2) / (1/0.5 - 1/2).
  const int crossing = 160;
  for (const int u : {50, 90, crossing + 3, 200, 240, 275}) {
    INFO("column " << u);
    CHECK(column(u) == 5);
    CHECK(picture(u, 150) == kBlue);
    CHECK(picture(u, 148) == kBlue);
    CHECK(picture(u, 152) == kBlue);
  }
  for (const int u : {105, 130, crossing - 3}) {
    INFO("column " << u);
    CHECK(column(u) == 0);
    const Rgb hidden = picture(u, 150), beside = picture(u, 160);
    CHECK(hidden.b > beside.b + 40);
    CHECK(hidden.g > 80);  // most of it is the wall's
  }
  CHECK(column(36) == 0);
  CHECK(column(284) == 0);
}

TEST_CASE("a line that begins behind the eye is drawn as far as it is before it", "[render][map]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Eigen::Vector3f end = kCamera.unproject(250, 60, 1).cast<float>();
  const Eigen::Vector3f beyond = -0.5f * end;  // on the ray of the same pixel, behind
  const Eigen::Vector3f aside(0.0f, 0.3f, -1.0f);
  const std::array lines{MapLine{aside, end, kBlue, 3}, MapLine{beyond, aside, {255, 0, 0}, 9}};
  ColorImage picture;
  gl.renderer->draw({.camera = kCamera, .lines = lines}, picture);
  CHECK(picture(250, 60) == kBlue);
  // The line is cut off at the near plane, below the picture's middle.
  const Eigen::Vector3d middle = (0.5 * (0.5f * (aside + end) + end)).cast<double>();
  const Eigen::Vector2d p = kCamera.project(middle);
  CHECK(picture(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))) ==
        kBlue);
  CHECK(std::none_of(picture.begin(), picture.end(), [](Rgb c) { return c == Rgb{255, 0, 0}; }));
}

TEST_CASE("points and bodies hide what is behind them and are hidden by what is before them",
          "[render][map]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Wall wall(0.8, 99.5, 219.5);
  gl.renderer->set_surface(wall.surface());
  const std::array points{
      MapPoint{kCamera.unproject(150, 60, 0.5).cast<float>(), 0.01f, {250, 200, 40}},
      MapPoint{kCamera.unproject(200, 60, 1.0).cast<float>(), 0.01f, {250, 200, 40}}};
  const SurfaceMesh ball = sphere_surface(kCamera.unproject(150, 180, 0.6), 0.03, 3);
  const Eigen::Matrix3Xf vertices = ball.vertices.cast<float>();
  Eigen::Matrix3Xf normals(3, vertices.cols());
  vertex_normals(vertices, ball.triangles, normals);
  BodyLook body;
  body.vertices = &vertices;
  body.normals = &normals;
  body.triangles = &ball.triangles;
  ColorImage picture;
  gl.renderer->draw({.camera = kCamera, .points = points, .bodies = {&body, 1}}, picture);
  CHECK(picture(150, 60).g > 100);  // yellow before red
  CHECK(reddish(picture(200, 60)));
  CHECK_FALSE(greenish(picture(150, 180)));
  CHECK(greenish(picture(200, 180)));
}

TEST_CASE("a picture that is drawn twice as large and averaged shows the same, softer",
          "[render][map]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Wall wall(0.8, 99.5, 219.5);
  gl.renderer->set_surface(wall.surface());
  const std::array lines{MapLine{kCamera.unproject(40, 30, 0.5).cast<float>(),
                                 kCamera.unproject(280, 200, 0.5).cast<float>(), kBlue, 4}};
  ColorImage plain, fine;
  gl.renderer->draw({.camera = kCamera, .lines = lines}, plain);
  gl.renderer->draw({.camera = kCamera, .lines = lines, .supersampling = 2}, fine);
  REQUIRE(fine.width() == plain.width());
  int different = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    different += is_near(plain.data()[i], fine.data()[i], 40) ? 0 : 1;
  }
  CHECK(different < 60);  // along 290 px of line's edges
  CHECK(fine(160, 115) == plain(160, 115));
}

TEST_CASE("a frustum opens from the eye to the picture's corners", "[render][map]") {
  std::vector<MapLine> lines;
  Rigid3 world_from_camera = Rigid3::Identity();
  world_from_camera.translation() = Eigen::Vector3d(1, 2, 3);
  add_frustum(lines, kCamera, world_from_camera, 0.5, kBlue, 2);
  REQUIRE(lines.size() == 8);
  int from_eye = 0;
  for (const MapLine& line : lines) {
    if (line.from == Eigen::Vector3f(1, 2, 3)) ++from_eye;
    CHECK(line.to.z() == Approx(3.5f));
    const Eigen::Vector2d p = kCamera.project((line.to - Eigen::Vector3f(1, 2, 3)).cast<double>());
    CHECK(std::min(std::abs(p.x() + 0.5), std::abs(p.x() - 321.5)) < 1e-3);
    CHECK(std::min(std::abs(p.y() + 0.5), std::abs(p.y() - 240.5)) < 1e-3);
  }
  CHECK(from_eye == 4);
}

TEST_CASE("from the second picture on drawing a map takes no memory", "[render][map]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Wall wall(0.8, 99.5, 219.5);
  gl.renderer->set_surface(wall.surface());
  const std::array lines{
      MapLine{Eigen::Vector3f(0, 0, 0.5f), Eigen::Vector3f(0.1f, 0, 0.5f), kBlue, 4}};
  const std::array points{MapPoint{Eigen::Vector3f(0, 0, 0.5f), 0.01f, kBlue}};
  ColorImage picture;
  const MapView view{.camera = kCamera, .lines = lines, .points = points};
  gl.renderer->draw(view, picture);
  CHECK(test::allocations_during([&] { gl.renderer->draw(view, picture); }) == 0);
}

TEST_CASE("a surface without a colour for each vertex is refused", "[render][map]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Wall wall(0.8, 99.5, 219.5);
  MapSurface surface = wall.surface();
  surface.colors = surface.colors.first(7);
  CHECK_THROWS_AS(gl.renderer->set_surface(surface), ContractViolation);
}
