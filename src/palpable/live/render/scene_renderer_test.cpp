#include "palpable/live/render/scene_renderer.h"

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/ground_shadow.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

using namespace palpable;
using palpable::test::tolerance;

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Off-centre principal point, unequal focal lengths, odd size, so that no errors cancel by
/// symmetry.
const PinholeCamera kCamera{322, 241, 410.0, 395.0, 171.3, 108.6};

/// A surface, as arrays for a BodyLook to point to.
struct Skin {
  explicit Skin(const SurfaceMesh& surface)
      : vertices(surface.vertices.cast<float>()), triangles(surface.triangles) {
    normals.resize(3, vertices.cols());
    vertex_normals(vertices, triangles, normals);
  }
  [[nodiscard]] BodyLook look(float shadow = 0) const {
    BodyLook body;
    body.vertices = &vertices;
    body.normals = &normals;
    body.triangles = &triangles;
    body.shadow = shadow;
    return body;
  }
  Eigen::Matrix3Xf vertices, normals;
  Eigen::Matrix3Xi triangles;
};

struct Drawn {
  ColorImage picture;
  MaskImage visible;
  DepthImage depth;
  [[nodiscard]] long seen() const {
    return std::count(visible.begin(), visible.end(), std::uint8_t{255});
  }
};

Drawn draw(SceneRenderer& renderer, const SceneView& view) {
  Drawn drawn;
  renderer.draw(view, drawn.picture, &drawn.visible, &drawn.depth);
  return drawn;
}

/// A thin plate whose front face lies at Z = 0.5 m and covers u 100..200, v 50..150 of kCamera:
/// 100 x 100 pixels, the edges half way between pixel centres.
Skin plate() {
  const Eigen::Vector3d a = kCamera.unproject(99.5, 49.5, 0.5);
  const Eigen::Vector3d b = kCamera.unproject(199.5, 149.5, 0.5);
  return Skin(box_surface({a.x(), a.y(), 0.5}, {b.x(), b.y(), 0.501}));
}

/// Real depth of the size of kCamera / `factor`: `left` in the columns before `border_px` of the
/// picture, `right` from there on.
DepthImage two_walls(float left, float right, int border_px, int factor) {
  DepthImage depth(kCamera.width / factor, kCamera.height / factor, right);
  for (int y = 0; y < depth.height(); ++y) std::fill_n(depth.row(y), border_px / factor, left);
  return depth;
}

/// The context and the renderer of one test; skips the test where there is no context.
struct Renderer {
  Result<GlContext> context = GlContext::offscreen();
  std::unique_ptr<SceneRenderer> renderer;
  bool ready() {
    if (!context.ok()) return false;
    renderer = std::make_unique<SceneRenderer>(value_or_throw(SceneRenderer::make()));
    return true;
  }
  ~Renderer() {
    if (context.ok()) {
      INFO(context.value().errors().first());
      CHECK(context.value().errors().count() == 0);
    }
  }
};

}  // namespace

#define PALPABLE_NEEDS_RENDERER(name) \
  Renderer name;                      \
  if (!name.ready()) PALPABLE_SKIP(name.context.problem().message)

TEST_CASE("of translucent bodies the nearest surface is mixed with what is behind all of them",
          "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  const ColorImage background(kCamera.width, kCamera.height, {90, 130, 60});
  const auto middle_of = [&](std::vector<BodyLook> bodies) {
    const SceneView view{.background = &background, .camera = kCamera, .bodies = std::move(bodies)};
    return draw(*gl.renderer, view).picture(150, 100);
  };
  BodyLook red = skin.look(), blue = skin.look();
  red.material = {200, 30, 30};
  blue.material = {30, 30, 200};
  blue.camera_from_body.translation().z() = 0.05;  // behind
  BodyLook clear_red = red, clear_blue = blue;
  clear_red.opacity = clear_blue.opacity = 0.4f;

  const auto is_mix = [](const Rgb& mixed, const Rgb& above, const Rgb& below) {
    const auto channel = [](int m, int a, int b) {
      return std::abs(m - (0.4 * a + 0.6 * b)) < 2.5;
    };
    return channel(mixed.r, above.r, below.r) && channel(mixed.g, above.g, below.g) &&
           channel(mixed.b, above.b, below.b);
  };
  const Rgb red_alone = middle_of({red}), blue_alone = middle_of({blue});
  const Rgb over_background = middle_of({clear_red});
  CHECK(is_mix(over_background, red_alone, background(150, 100)));
  CHECK(is_mix(middle_of({clear_red, blue}), red_alone, blue_alone));
  CHECK(is_mix(middle_of({blue, clear_red}), red_alone, blue_alone));
  CHECK(middle_of({red, clear_blue}) == red_alone);
  CHECK(middle_of({clear_red, clear_blue}) == over_background);
}

TEST_CASE("a real surface nearer than the body hides it", "[render][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  const ColorImage background(kCamera.width, kCamera.height, {90, 130, 60});
  for (const int factor : {1, 2}) {
    INFO("depth at 1/" << factor);
    const DepthImage wall(kCamera.width / factor, kCamera.height / factor, 0.45f);
    const Drawn drawn = draw(*gl.renderer, {.background = &background,
                                            .real_depth = &wall,
                                            .camera = kCamera,
                                            .bodies = {skin.look()}});
    CHECK(drawn.seen() == 0);
    CHECK(drawn.picture == background);
    CHECK(drawn.depth(150, 100) == Approx(0.5));
  }
}

TEST_CASE("a body nearer than a real surface hides that", "[render][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  const ColorImage background(kCamera.width, kCamera.height, {90, 130, 60});
  for (const int factor : {1, 2}) {
    INFO("depth at 1/" << factor);
    const DepthImage wall(kCamera.width / factor, kCamera.height / factor, 0.6f);
    const Drawn drawn = draw(*gl.renderer, {.background = &background,
                                            .real_depth = &wall,
                                            .camera = kCamera,
                                            .bodies = {skin.look()}});
    CHECK(drawn.seen() == 100 * 100);
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        const bool inside = x >= 100 && x < 200 && y >= 50 && y < 150;
        CHECK((drawn.visible(x, y) == 255) == inside);
        CHECK(std::isnan(drawn.depth(x, y)) == !inside);
        // The soft outline extends one pixel beyond the edge.
        const bool near = x >= 99 && x < 201 && y >= 49 && y < 151;
        if (!near) CHECK(drawn.picture(x, y) == background(x, y));
      }
    }
    CHECK_FALSE(drawn.picture(150, 100) == background(150, 100));
  }
}

TEST_CASE("each pixel decides for itself: part of the body may be hidden", "[render][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  for (const int factor : {1, 2}) {
    INFO("depth at 1/" << factor);
    // A hand from the left that ends at column 140; behind it a wall.
    const DepthImage real = two_walls(0.45f, 0.8f, 140, factor);
    const Drawn drawn =
        draw(*gl.renderer, {.real_depth = &real, .camera = kCamera, .bodies = {skin.look()}});
    for (int y = 50; y < 150; ++y) {
      const auto* row = drawn.visible.row(y);
      CHECK(std::abs(std::count(row, row + kCamera.width, std::uint8_t{255}) - 60) <= 1);
      CHECK(row[138] == 0);
      CHECK(row[142] == 255);
    }
  }
}

TEST_CASE("before a body the picture's colours say where a widened outline of half depth lies",
          "[render][outlines][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  // A hand from the right that begins at column 141 of the picture, and 4 texels further left in
  // the depth.
  ColorImage background(kCamera.width, kCamera.height, {187, 146, 104});
  DepthImage real(kCamera.width / 2, kCamera.height / 2, 0.8f);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 141; x < kCamera.width; ++x) background(x, y) = {224, 176, 150};
    for (int u = 141 / 2 - 4; u < real.width() && y / 2 < real.height(); ++u) {
      real(u, y / 2) = 0.45f;
    }
  }
  SceneView view{
      .background = &background, .real_depth = &real, .camera = kCamera, .bodies = {skin.look()}};
  const Drawn drawn = draw(*gl.renderer, view);
  for (int y = 50; y < 150; ++y) {
    const auto* row = drawn.visible.row(y);
    CHECK(std::count(row, row + kCamera.width, std::uint8_t{255}) == 41);
    CHECK(row[140] == 255);
    CHECK(row[141] == 0);
  }
  // Without differences in colour the depth alone counts, which begins at column 2 * 66.
  view.background = nullptr;
  const Drawn coarse = draw(*gl.renderer, view);
  CHECK(std::abs(coarse.seen() - 32 * 100) <= 100);
}

TEST_CASE("a surface that touches the body does not hide it, one before it does",
          "[render][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  DepthImage real(kCamera.width, kCamera.height);
  const auto seen_behind = [&](float z) {
    std::fill(real.begin(), real.end(), z);
    return draw(*gl.renderer, {.real_depth = &real, .camera = kCamera, .bodies = {skin.look()}})
        .seen();
  };
  // The bias at 0.5 m is 2.5 mm; half hidden at 1.5 times that.
  CHECK(seen_behind(0.5f) == 10000);
  CHECK(seen_behind(0.5f - 0.0035f) == 10000);
  CHECK(seen_behind(0.5f - 0.0040f) == 0);
}

TEST_CASE("moving pixels too near for any depth hide the body, if there is a moving mask",
          "[render][outlines][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  // A finger from the left that ends at column 140; nothing is known of its depth.
  ColorImage background(kCamera.width, kCamera.height, {187, 146, 104});
  DepthImage real(kCamera.width / 2, kCamera.height / 2, 0.8f);
  MaskImage moving(real.width(), real.height(), 0), too_close = moving;
  for (int y = 0; y < real.height(); ++y) {
    for (int x = 0; x < 70; ++x) {
      real(x, y) = kUnknown;
      moving(x, y) = 255;
    }
    std::fill_n(background.row(2 * y), 140, Rgb{224, 176, 150});
    std::fill_n(background.row(2 * y + 1), 140, Rgb{224, 176, 150});
  }
  SceneView view{
      .background = &background, .real_depth = &real, .camera = kCamera, .bodies = {skin.look()}};
  CHECK(draw(*gl.renderer, view).seen() >= 9900);
  view.moving = &moving;
  CHECK(std::abs(draw(*gl.renderer, view).seen() - 60 * 100) <= 100);
  // The same by the matcher's marks, without a moving mask.
  view.moving = nullptr;
  for (int y = 0; y < real.height(); ++y) {
    for (int x = y % 3; x < 70; x += 3) too_close(x, y) = 255;
  }
  view.too_close = &too_close;
  CHECK(std::abs(draw(*gl.renderer, view).seen() - 60 * 100) <= 100);
}

TEST_CASE("the hard test uses the measured depth of each pixel alone", "[render][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  for (const int factor : {1, 2}) {
    INFO("depth at 1/" << factor);
    const ColorImage background(kCamera.width, kCamera.height, {90, 130, 60});
    // A surface nearer than the body by less than the soft test's bias, with a single hole; no
    // surface on the right, where a strip that one eye alone sees would get a depth.
    DepthImage real = two_walls(0.499f, 0.6f, 140, factor);
    real(120 / factor, 100 / factor) = kUnknown;
    SceneView view{.background = &background,
                   .real_depth = &real,
                   .hard_occlusion = true,
                   .camera = kCamera,
                   .bodies = {skin.look()}};
    const Drawn drawn = draw(*gl.renderer, view);
    CHECK(drawn.seen() == 60 * 100 + factor * factor);
    CHECK(drawn.visible(120, 100) == 255);
    view.hard_occlusion = false;
    CHECK(draw(*gl.renderer, view).seen() == 10000);
  }
}

TEST_CASE("unknown depth does not hide the body", "[render][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  for (const float nothing : {kUnknown, 0.0f, -1.0f, std::numeric_limits<float>::infinity()}) {
    INFO("in place of a depth: " << nothing);
    const DepthImage unknown(kCamera.width / 2, kCamera.height / 2, nothing);
    const Drawn drawn =
        draw(*gl.renderer, {.real_depth = &unknown, .camera = kCamera, .bodies = {skin.look()}});
    CHECK(drawn.seen() == 10000);
  }
}

TEST_CASE("a small hole in a real surface does not let the body through", "[render][Fig9]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  DepthImage real(kCamera.width, kCamera.height, 0.45f);
  for (int y = 90; y < 98; ++y) std::fill_n(real.row(y) + 150, 8, kUnknown);
  const Drawn small =
      draw(*gl.renderer, {.real_depth = &real, .camera = kCamera, .bodies = {skin.look()}});
  CHECK(small.seen() == 0);
  // Of a large hole, the pixels farther than 6 texels from its rim remain: 40 - 12 in each
  // direction, and at most one more row and column because the decision is interpolated.
  for (int y = 70; y < 110; ++y) std::fill_n(real.row(y) + 120, 40, kUnknown);
  const Drawn large =
      draw(*gl.renderer, {.real_depth = &real, .camera = kCamera, .bodies = {skin.look()}});
  CHECK(large.seen() >= 27 * 27);
  CHECK(large.seen() <= 30 * 30);
}

TEST_CASE("the metric depth of a sphere is that of its equation", "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Eigen::Vector3d centre(0.02, -0.015, 0.45);
  constexpr double kRadius = 0.06;
  const Skin skin(sphere_surface(Eigen::Vector3d::Zero(), kRadius, 5));
  BodyLook look = skin.look();
  // A rotation must not matter for a sphere, and must be applied.
  look.camera_from_body.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  look.camera_from_body.translation() = centre;
  const Drawn drawn = draw(*gl.renderer, {.camera = kCamera, .bodies = {look}});
  int compared = 0;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      // |z ray - centre|^2 = r^2 with ray = (X/Z, Y/Z, 1)
      const Eigen::Vector3d ray = kCamera.unproject(x, y, 1.0);
      const double a = ray.squaredNorm(), b = ray.dot(centre);
      const double root = b * b - a * (centre.squaredNorm() - kRadius * kRadius);
      const bool inside = root > 0;
      // The outline of the facets lies up to 0.1 px inside the sphere's, so the rim is left out.
      if (std::abs(root) < 0.03 * b * b * kRadius * kRadius / centre.squaredNorm()) continue;
      CHECK(std::isnan(drawn.depth(x, y)) == !inside);
      if (!inside || root < 0.25 * b * b * kRadius * kRadius / centre.squaredNorm()) continue;
      const double z = (b - std::sqrt(root)) / a;
      CHECK(
          std::abs(drawn.depth(x, y) - z) <=
          tolerance(1e-4,
                    "facets of 2.5 degrees lie up to 14 um below the sphere, seen at 60 degrees") *
              z);
      ++compared;
    }
  }
  CHECK(compared > 5000);
}

TEST_CASE("the picture's geometry is PinholeCamera's to a tenth of a pixel", "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  int compared = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    // One triangle at a random position before the camera.
    SurfaceMesh surface;
    surface.vertices.resize(3, 3);
    surface.triangles.resize(3, 2);
    surface.triangles << 0, 0, 1, 2, 2, 1;  // both sides
    std::array<Eigen::Vector2d, 3> corner;
    for (int i = 0; i < 3; ++i) {
      const double angle = 2.1 * i + 0.8 * unit(random);
      const Eigen::Vector3d x = kCamera.unproject(
          160 + 100 * std::cos(angle), 120 + 95 * std::sin(angle), 0.5 + 0.3 * unit(random));
      surface.vertices.col(i) = x;
      corner[i] = kCamera.project(x);
    }
    const Drawn drawn = draw(*gl.renderer, {.camera = kCamera, .bodies = {Skin(surface).look()}});
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        double inside = 1e9;  // px to the nearest edge, positive within
        for (std::size_t i = 0; i < 3; ++i) {
          const Eigen::Vector2d edge = (corner[(i + 1) % 3] - corner[i]).normalized();
          const Eigen::Vector2d to = Eigen::Vector2d(x, y) - corner[i];
          inside = std::min(inside, edge.x() * to.y() - edge.y() * to.x());
        }
        if (std::abs(inside) < tolerance(0.1, "the promise; windows have 1/256 px")) continue;
        CHECK(std::isnan(drawn.depth(x, y)) == (inside < 0));
        ++compared;
      }
    }
  }
  CHECK(compared > 100'000);
}

TEST_CASE("of two bodies the nearer one is seen, whatever their order", "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin near(sphere_surface({0, 0, 0.4}, 0.03, 3));
  const Skin far(sphere_surface({0, 0, 0.6}, 0.09, 3));
  const Drawn one = draw(*gl.renderer, {.camera = kCamera, .bodies = {near.look(), far.look()}});
  const Drawn two = draw(*gl.renderer, {.camera = kCamera, .bodies = {far.look(), near.look()}});
  CHECK(one.depth(171, 108) == Approx(0.37).margin(1e-4));
  CHECK(one.visible == two.visible);
  CHECK(one.picture == two.picture);
}

TEST_CASE("stress is painted: more of it is lighter, marks cover it", "[render][Fig16]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  bool blended = false;
  const auto color_at = [&](float stress, float mark) {
    const std::vector<float> scalar(skin.vertices.cols(), stress);
    const std::vector<float> marks(scalar.size(), mark);
    BodyLook look = skin.look();
    look.scalar = scalar;
    look.scalar_max = 20e3f;
    look.marks = marks;
    look.blended = blended;
    return draw(*gl.renderer, {.camera = kCamera, .bodies = {look}}).picture(150, 100);
  };
  const auto sum = [](Rgb c) { return c.r + c.g + c.b; };
  CHECK(sum(color_at(0, 0)) < sum(color_at(10e3f, 0)));
  CHECK(sum(color_at(10e3f, 0)) < sum(color_at(20e3f, 0)));
  CHECK(color_at(20e3f, 0) == color_at(50e3f, 0));
  CHECK(color_at(0, 1) == color_at(20e3f, 1));
  const Rgb marked = color_at(0, 1);
  CHECK((marked.r > marked.b + 50 && marked.g > marked.b + 30));  // yellow

  // With blending, the material is visible where the stress is near 0, and only there.
  const Rgb high = color_at(10e3f, 0);
  blended = true;
  const Rgb plain =
      draw(*gl.renderer, {.camera = kCamera, .bodies = {skin.look()}}).picture(150, 100);
  CHECK(color_at(0, 0) == plain);
  CHECK(color_at(0.4e3f, 0) == plain);
  CHECK(plain.r > plain.b + 20);  // rubber, and no blue
  CHECK(color_at(10e3f, 0) == high);
}

TEST_CASE("what has two signs is painted blue below 0 and red above, and not at all near it",
          "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  const auto color_at = [&](float pressure) {
    const std::vector<float> scalar(skin.vertices.cols(), pressure);
    BodyLook look = skin.look();
    look.scalar = scalar;
    look.scalar_max = 20e3f;
    look.two_sided = true;
    return draw(*gl.renderer, {.camera = kCamera, .bodies = {look}}).picture(150, 100);
  };
  const Rgb plain =
      draw(*gl.renderer, {.camera = kCamera, .bodies = {skin.look()}}).picture(150, 100);
  CHECK(color_at(0.4e3f) == plain);
  CHECK(color_at(-0.4e3f) == plain);
  const Rgb below = color_at(-15e3f), above = color_at(15e3f);
  CHECK(below.b > below.r + 40);
  CHECK(above.r > above.b + 40);
  CHECK(color_at(-50e3f) == color_at(-20e3f));
  CHECK(color_at(50e3f) == color_at(20e3f));
}

TEST_CASE("light has a direction, a strength and a colour", "[render][light]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin ball(sphere_surface({0, 0, 0.5}, 0.08, 4));
  SceneView view{.camera = kCamera, .bodies = {ball.look()}};
  view.light.to_lamp = Eigen::Vector3f(-0.8f, 0, -0.6f);
  const auto at = [&](double x) {
    const Eigen::Vector2d p = kCamera.project({x, 0, 0.5});
    return draw(*gl.renderer, view)
        .picture(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  };
  CHECK(at(-0.05).g > at(0.05).g + 40);
  view.light.to_lamp = Eigen::Vector3f(0.8f, 0, -0.6f);
  CHECK(at(0.05).g > at(-0.05).g + 40);
  const Rgb lit = at(0.05);
  view.light.color = {1, 1, 0.5f};
  CHECK(at(0.05).b < lit.b - 20);
  CHECK(at(0.05).g == lit.g);
  view.light.color = {1, 1, 1};
  view.light.lamp = 0.2f;
  CHECK(at(0.05).g < lit.g - 40);
  CHECK(at(-0.05).g == Approx(at(-0.02).g).margin(60));
}

TEST_CASE("what is real between lamp and body shades it", "[render][light]") {
  PALPABLE_NEEDS_RENDERER(gl);
  // A plate that faces the camera, lit from the left. A rod is before it, left of its middle.
  Eigen::Matrix3Xf grid(3, 41 * 41);
  Eigen::Matrix3Xi triangles(3, 2 * 40 * 40);
  for (int j = 0; j < 41; ++j) {
    for (int i = 0; i < 41; ++i) {
      grid.col(41 * j + i) = Eigen::Vector3f(0.004f * static_cast<float>(i - 20),
                                             0.004f * static_cast<float>(j - 20), 0.5f);
    }
  }
  int t = 0;
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 40; ++i) {
      const int a = 41 * j + i;
      triangles.col(t++) << a, a + 41, a + 1;
      triangles.col(t++) << a + 1, a + 41, a + 42;
    }
  }
  Skin skin{SurfaceMesh{grid.cast<double>(), triangles}};
  if (skin.normals(2, 0) > 0) {
    skin.triangles.row(1).swap(skin.triangles.row(2));
    skin.normals *= -1;
  }
  DepthImage real(kCamera.width, kCamera.height, 0.8f);
  const int rod = static_cast<int>(kCamera.project({-0.03, 0, 0.47}).x());
  for (int y = 0; y < real.height(); ++y) {
    for (int x = rod - 6; x < rod + 6; ++x) real(x, y) = 0.47f;
  }
  SceneView view{.real_depth = &real, .camera = kCamera, .bodies = {skin.look()}};
  view.light.to_lamp = Eigen::Vector3f(-0.6f, 0, -0.8f);
  const Drawn shaded = draw(*gl.renderer, view);
  DepthImage free(kCamera.width, kCamera.height, 0.8f);
  view.real_depth = &free;
  const Drawn lit = draw(*gl.renderer, view);
  // The rod is 30 mm before the plate, less than the thickness it is taken to have: the part of the
  // plate behind it, seen from the lamp, is in its shadow.
  const auto darker = [&](double x) {
    const Eigen::Vector2d p = kCamera.project({x, 0, 0.5});
    const int u = static_cast<int>(std::lround(p.x())), v = static_cast<int>(std::lround(p.y()));
    return lit.picture(u, v).g - shaded.picture(u, v).g;
  };
  CHECK(darker(-0.016) > 30);
  CHECK(darker(0.03) == 0);
  CHECK(darker(-0.065) == 0);
}

TEST_CASE("forces are arrows over all that is drawn", "[render][arrow]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  SceneView view{.camera = kCamera, .bodies = {skin.look()}};
  const ColorImage without = draw(*gl.renderer, view).picture;
  view.arrows.push_back(
      {kCamera.unproject(110, 60, 0.6), kCamera.unproject(180, 130, 0.6), {250, 0, 0}, "1.25 N"});
  const ColorImage with = draw(*gl.renderer, view).picture;
  CHECK(with(145, 95) == Rgb{250, 0, 0});  // behind the plate, but drawn in front
  CHECK_FALSE(with == without);
  view.arrows.front().tail.z() = -0.1;  // behind the camera
  CHECK(draw(*gl.renderer, view).picture == without);
}

TEST_CASE("a dot is a ball on the body", "[render][Fig15]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  const Eigen::Vector3d middle = kCamera.unproject(150, 100, 0.5);
  const std::array<Dot, 1> dots{Dot{middle.cast<float>(), 0.01f, {255, 0, 0}}};
  BodyLook look = skin.look();
  look.dots = dots;
  const Drawn drawn = draw(*gl.renderer, {.camera = kCamera, .bodies = {look}});
  CHECK(drawn.depth(150, 100) == Approx(0.49).margin(1e-4));
  // 0.01 m at 0.5 m are 8.2 px across 410 px of focal length.
  CHECK(drawn.depth(150 + 7, 100) < 0.4999f);
  CHECK(drawn.depth(150 + 9, 100) == Approx(0.5).margin(1e-5));
  CHECK(drawn.picture(150, 100).r > 2 * drawn.picture(150, 100).g);
}

TEST_CASE("the shadow darkens the plane that the body stands on and nothing above the body",
          "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin(sphere_surface({0, 0, 0.03}, 0.03, 4));
  BodyLook look = skin.look(0.6f);
  // The camera looks down at 45 degrees.
  look.camera_from_body.linear() =
      Eigen::AngleAxisd(-2.356194490192345 /* -135 degrees */, Eigen::Vector3d::UnitX())
          .toRotationMatrix();
  look.camera_from_body.translation() = Eigen::Vector3d(0, 0, 0.5);
  const ColorImage background(kCamera.width, kCamera.height, {200, 200, 200});
  const auto darkened = [&](const DepthImage* real, const MaskImage* moving = nullptr) {
    const Drawn drawn = draw(*gl.renderer, {.background = &background,
                                            .real_depth = real,
                                            .moving = moving,
                                            .camera = kCamera,
                                            .bodies = {look}});
    int count = 0;
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        bool near_body = false;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kCamera.height - 1); ++v) {
          for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kCamera.width - 1); ++u) {
            near_body = near_body || !std::isnan(drawn.depth(u, v));
          }
        }
        if (!near_body && drawn.picture(x, y).r < 180) ++count;
      }
    }
    return count;
  };
  // The plane Z_body = 0 as the camera sees it.
  const auto plane = [&](double offset) {
    DepthImage depth(kCamera.width, kCamera.height);
    const Eigen::Vector3d n = look.camera_from_body.linear().col(2);
    const double distance = n.dot(look.camera_from_body.translation());
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        const double z = distance / n.dot(kCamera.unproject(x, y, 1.0));
        depth(x, y) = z > 0 ? static_cast<float>(z + offset) : kUnknown;
      }
    }
    return depth;
  };
  const DepthImage desk = plane(0), hand = plane(-0.2), wall = plane(0.08);
  CHECK(darkened(nullptr) > 300);
  CHECK(darkened(&desk) == darkened(nullptr));
  CHECK(darkened(&hand) == 0);
  CHECK(darkened(&wall) == 0);
  // Pixels without depth are taken to lie there, unless they move: then they are too near for a
  // depth.
  const DepthImage unknown(kCamera.width, kCamera.height, kUnknown);
  const MaskImage moving(kCamera.width, kCamera.height, 255);
  CHECK(darkened(&unknown) == darkened(nullptr));
  CHECK(darkened(&unknown, &moving) == 0);
}

TEST_CASE("a shadow falls on what stands in it, as high as what throws it", "[render][light]") {
  PALPABLE_NEEDS_RENDERER(gl);
  // A box 60 mm high seen from above, with light from the left at 45 degrees.
  Rigid3 camera_from_body = Rigid3::Identity();
  camera_from_body.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  camera_from_body.translation() = Eigen::Vector3d(0, 0, 0.6);
  const Skin skin(box_surface({-0.03, -0.03, 0}, {0.03, 0.03, 0.06}));
  BodyLook look = skin.look(0.5f);
  look.camera_from_body = camera_from_body;
  const ColorImage background(kCamera.width, kCamera.height, {180, 180, 180});
  SceneView view{.background = &background, .camera = kCamera, .bodies = {look}};
  view.light.to_lamp =
      (camera_from_body.linear() * Eigen::Vector3d(-1, 0, 1).normalized()).cast<float>();
  // Right of the box there is a thing of the given height everywhere.
  const auto shade_at = [&](float height) {
    const DepthImage real(kCamera.width, kCamera.height, 0.6f - height);
    view.real_depth = &real;
    const Eigen::Vector2d p = kCamera.project(camera_from_body * Eigen::Vector3d(0.05, 0, height));
    return 180 -
           draw(*gl.renderer, view)
               .picture(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())))
               .g;
  };
  CHECK(shade_at(0) > 15);
  CHECK(shade_at(0.025f) > 5);
  CHECK(shade_at(0.1f) == 0);   // above the box
  CHECK(shade_at(-0.1f) == 0);  // far below the plane
}

TEST_CASE("what was drawn before leaves nothing in a picture", "[render][light]") {
  PALPABLE_NEEDS_RENDERER(gl);
  Rigid3 camera_from_body = Rigid3::Identity();
  camera_from_body.linear() << 1, 0, 0, 0, -0.5, -0.8660254, 0, 0.8660254, -0.5;
  camera_from_body.translation() = Eigen::Vector3d(0, 0.02, 0.5);
  const auto look_of = [&](const Skin& skin) {
    BodyLook look = skin.look(0.5f);
    look.camera_from_body = camera_from_body;
    return look;
  };
  const ColorImage background(kCamera.width, kCamera.height, {226, 226, 226});
  for (const double smaller : {0.7, 0.93, 1.13}) {
    const Skin ball(sphere_surface({0, 0, 0.04}, 0.04, 3));
    const Skin other(sphere_surface({0.003, 0, smaller * 0.04}, smaller * 0.04, 3));
    SceneView view{.background = &background, .camera = kCamera, .bodies = {look_of(ball)}};
    const ColorImage first = draw(*gl.renderer, view).picture;
    view.bodies = {look_of(other)};
    (void)draw(*gl.renderer, view);
    view.bodies = {look_of(ball)};
    CHECK(draw(*gl.renderer, view).picture == first);
  }
}

TEST_CASE("a shadow is darkest at the body's foot and gone at its rim", "[render]") {
  const Skin skin(box_surface({-0.02, -0.03, 0}, {0.02, 0.03, 0.1}));
  GroundShadow shadow;
  shadow.cast(skin.vertices, skin.triangles, Eigen::Vector3f(-0.3f, 0, 1).normalized());
  const auto at = [&](float x, float y) {
    const Eigen::Vector4f& box = shadow.box();
    const auto cell = [](float t) { return static_cast<std::size_t>(t * GroundShadow::kSide); };
    const std::size_t column = cell((x - box[0]) / (box[2] - box[0]));
    const std::size_t row = cell((y - box[1]) / (box[3] - box[1]));
    return shadow.shade()[row * GroundShadow::kSide + column];
  };
  CHECK(at(0, 0) > 0.8f);
  CHECK(at(0.035f, 0) > 0.05f);  // on the side away from the light, which comes from -x
  CHECK(at(0.035f, 0) < at(0, 0));
  CHECK(at(-0.035f, 0) < at(0.035f, 0));
  for (int i = 0; i < GroundShadow::kSide; ++i) {
    CHECK(shadow.shade()[i] == 0.0f);
    CHECK(shadow.shade()[i * GroundShadow::kSide] == 0.0f);
  }
  shadow.cast(skin.vertices, skin.triangles, Eigen::Vector3f(0, 0, -1));
  CHECK(*std::max_element(shadow.shade().begin(), shadow.shade().end()) == 0.0f);
}

TEST_CASE("a body out of sight, behind the camera or of nothing leaves the background as it is",
          "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const ColorImage background(kCamera.width, kCamera.height, {1, 2, 3});
  const Skin empty{SurfaceMesh{}};
  const Skin away(sphere_surface({5, 0, 0.5}, 0.05, 2));
  const Skin behind(sphere_surface({0, 0, -0.5}, 0.05, 2));
  for (const Skin* skin : {&empty, &away, &behind}) {
    const Drawn drawn = draw(
        *gl.renderer, {.background = &background, .camera = kCamera, .bodies = {skin->look(0.5f)}});
    CHECK(drawn.picture == background);
    CHECK(drawn.seen() == 0);
  }
  CHECK(draw(*gl.renderer, {.background = &background, .camera = kCamera}).picture == background);
}

TEST_CASE("a body around the camera fills the picture without an error", "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  Skin room(sphere_surface({0, 0, 0}, 0.5, 3));
  room.triangles.row(1).swap(room.triangles.row(2));  // seen from inside
  const Drawn drawn = draw(*gl.renderer, {.camera = kCamera, .bodies = {room.look()}});
  CHECK(drawn.seen() == static_cast<long>(kCamera.width) * kCamera.height);
}

TEST_CASE("sizes that do not match are the caller's bug", "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin = plate();
  ColorImage picture;
  const ColorImage small(10, 10);
  CHECK_THROWS_AS(gl.renderer->draw({.background = &small, .camera = kCamera}, picture),
                  ContractViolation);
  const std::vector<float> scalar(3);
  BodyLook look = skin.look();
  look.scalar = scalar;
  CHECK_THROWS_AS(gl.renderer->draw({.camera = kCamera, .bodies = {look}}, picture),
                  ContractViolation);
  look = skin.look();
  look.scalar_max = 0;
  CHECK_THROWS_AS(gl.renderer->draw({.camera = kCamera, .bodies = {look}}, picture),
                  ContractViolation);
}

TEST_CASE("drawing again allocates nothing of ours, and gives the same picture", "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin(sphere_surface({0, 0, 0.5}, 0.05, 4));
  const std::vector<float> stress(skin.vertices.cols(), 3e3f);
  const std::array<Dot, 2> dots{Dot{{0, 0, 0.45f}, 0.003f, {}}, Dot{{0.05f, 0, 0.5f}, 0.003f, {}}};
  const ColorImage background(kCamera.width, kCamera.height, {80, 90, 100});
  const DepthImage real = two_walls(0.4f, 0.7f, 160, 2);
  BodyLook look = skin.look(0.5f);
  look.scalar = stress;
  look.scalar_max = 10e3f;
  look.dots = dots;
  const SceneView view{.background = &background,
                       .real_depth = &real,
                       .camera = kCamera,
                       .bodies = {look},
                       .legend_title = "von Mises",
                       .caption = {"site 3, level 0.50"}};
  const Drawn first = draw(*gl.renderer, view);
  Drawn again = first;
  CHECK(test::allocations_during(
            [&] { gl.renderer->draw(view, again.picture, &again.visible, &again.depth); }) == 0);
  CHECK(again.picture == first.picture);
  CHECK(again.visible == first.visible);
}

TEST_CASE("a picture of another size needs no new renderer", "[render]") {
  PALPABLE_NEEDS_RENDERER(gl);
  const Skin skin(sphere_surface({0, 0, 0.5}, 0.05, 3));
  const SceneView large{.camera = kCamera, .bodies = {skin.look()}};
  const SceneView small{.camera = kCamera.scaled_down(2), .bodies = {skin.look()}};
  const long seen_large = draw(*gl.renderer, large).seen();
  const long seen_small = draw(*gl.renderer, small).seen();
  CHECK(static_cast<double>(seen_large) / static_cast<double>(seen_small) ==
        Approx(4.0).epsilon(0.03));
  CHECK(draw(*gl.renderer, large).seen() == seen_large);
}
