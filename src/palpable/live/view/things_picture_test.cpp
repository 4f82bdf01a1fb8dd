#include "palpable/live/view/things_picture.h"

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/render/gl_context.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <vector>

namespace palpable {
namespace {

constexpr PictureSize kSize{320, 180};

std::shared_ptr<const TouchableBody> ball() {
  const ReducedBody body = test::DentedSphere{}.body();
  return std::make_shared<const TouchableBody>(body, test::yielding_tables(body.surface));
}

// Bodies at rest.
Scene scene_of(const std::vector<ThingsPicture::Body>& bodies) {
  Scene scene;
  for (const ThingsPicture::Body& body : bodies) {
    const SurfaceMesh& skin = body.body->body.surface;
    SceneBody& shown = scene.bodies.emplace_back();
    shown.vertices = skin.vertices.cast<float>();
    shown.normals.resize(3, shown.vertices.cols());
    vertex_normals(shown.vertices, skin.triangles, shown.normals);
    shown.von_mises.assign(static_cast<std::size_t>(skin.vertex_count()), 0.0f);
  }
  return scene;
}

int difference(const Rgb& p, const Rgb& q) {
  return std::abs(p.r - q.r) + std::abs(p.g - q.g) + std::abs(p.b - q.b);
}

// The number of pixels in which two pictures differ.
int others(const ColorImage& a, const ColorImage& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += difference(a.data()[i], b.data()[i]) > 6;
  return count;
}

// The pixel of a point of the world, in a picture of bodies whose first one stands at the origin.
Eigen::Vector2i pixel_of(const OrbitCamera& orbit, const Eigen::Vector3d& x) {
  const PinholeCamera camera = camera_of_view(kSize.width, kSize.height, kStudioView);
  const Eigen::Vector2d at = camera.project(orbit.camera_from_body() * x);
  return at.array().round().cast<int>();
}

TEST_CASE("what presses is drawn where it is, and the body is visible through it", "[view]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const std::vector<ThingsPicture::Body> bodies{{ball()}};
  const Scene scene = scene_of(bodies);
  ThingsPicture picture(bodies, kSize, 1e4);
  const ColorImage alone = picture.draw(scene, {});
  // A capsule halfway between the eye and the middle of the body, and one beside the body.
  const Eigen::Vector3d middle = picture.camera.target;
  const Eigen::Vector3d before = 0.5 * (middle + picture.camera.eye());
  const Eigen::Vector3d beside = middle + Eigen::Vector3d(0, 0, 0.062);
  const std::vector<Capsule> things{{before, before + Eigen::Vector3d(0, 0, 0.001), 0.004, 0.004},
                                    {beside, beside + Eigen::Vector3d(0, 0, 0.002), 0.006, 0.006}};
  const ColorImage with = picture.draw(scene, things);
  const Eigen::Vector2i on_body = pixel_of(picture.camera, middle);
  const Eigen::Vector2i on_floor = pixel_of(picture.camera, beside + Eigen::Vector3d(0, 0, 0.001));
  CHECK(difference(with(on_body.x(), on_body.y()), alone(on_body.x(), on_body.y())) > 20);
  CHECK(difference(with(on_floor.x(), on_floor.y()), alone(on_floor.x(), on_floor.y())) > 20);
  // Drawn opaque both would have one colour; through the first one the body is visible.
  CHECK(difference(with(on_body.x(), on_body.y()), with(on_floor.x(), on_floor.y())) > 10);
  CHECK(picture.draw(scene, {}) == alone);
  CHECK(context.value().errors().count() == 0);
}

TEST_CASE("a capsule that moved, turned or grew is drawn as in a picture of its own", "[view]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const std::vector<ThingsPicture::Body> bodies{{ball()}};
  const Scene scene = scene_of(bodies);
  ThingsPicture kept(bodies, kSize, 1e4);
  const Eigen::Vector3d above = kept.camera.target + Eigen::Vector3d(0, 0, 0.07);
  const Capsule capsule{above, above + Eigen::Vector3d(0, 0, 0.02), 0.006, 0.004};
  std::vector<std::vector<Capsule>> frames(6, {capsule});
  frames[1][0].b = above + Eigen::Vector3d(0.02, 0, 0);   // turned
  frames[2][0].b = above + Eigen::Vector3d(0, 0, -0.02);  // upside down
  frames[3][0].b = above;                                 // a ball
  frames[4][0].ra = 0.009;                                // grown
  frames[5].push_back({above + Eigen::Vector3d(0.03, 0, 0), above, 0.003, 0.003});
  for (const std::vector<Capsule>& things : frames) {
    ThingsPicture fresh(bodies, kSize, 1e4);
    const ColorImage picture = kept.draw(scene, things);
    CHECK(others(picture, fresh.draw(scene, things)) < 5);  // a length may differ in its last bit
    CHECK(others(picture, fresh.draw(scene, {})) > 50);
  }
  kept.legend = false;
  const ColorImage bare = kept.draw(scene, {});
  kept.legend = true;
  CHECK_FALSE(bare == kept.draw(scene, {}));
}

TEST_CASE("all bodies are in the picture, each where it stands", "[view]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  std::vector<ThingsPicture::Body> bodies{{ball()}, {ball()}};
  bodies[1].world_from_body.translation() = Eigen::Vector3d(0.25, 0, 0);
  ThingsPicture picture(bodies, kSize, 1e4);
  const Scene scene = scene_of(bodies);
  const ColorImage both = picture.draw(scene, {});
  for (const double x : {0.0, 0.25}) {
    const Eigen::Vector2i at = pixel_of(picture.camera, Eigen::Vector3d(x, 0, 0.05));
    REQUIRE(
        (at.x() > 10 && at.x() < kSize.width - 10 && at.y() > 10 && at.y() < kSize.height - 10));
    // Rubber is warmer than the studio: more red than blue.
    const Rgb color = both(at.x(), at.y());
    CHECK(color.r > color.b + 15);
  }
  const Eigen::Vector2i between = pixel_of(picture.camera, Eigen::Vector3d(0.125, 0, 0.05));
  const Rgb color = both(between.x(), between.y());
  CHECK(color.r < color.b + 15);
}

}  // namespace
}  // namespace palpable
