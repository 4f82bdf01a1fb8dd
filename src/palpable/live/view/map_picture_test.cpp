#include "palpable/live/view/map_picture.h"

#include "palpable/live/render/gl_context.h"
#include "palpable/live/session/frame_loop.h"
#include "palpable/live/view/scene_picture.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/seen_wall.h"
#include "tests/support/test.h"

#include <algorithm>
#include <optional>

namespace palpable {
namespace {

// A session that tracks a camera before a wall, and the picture of its map from outside.
struct Outside {
  Result<GlContext> context = GlContext::offscreen();
  std::optional<FrameLoop> loop;
  std::optional<MapPicture> map;
  ColorImage inside, picture;
  int number = 0;

  bool ready() {
    if (!context.ok()) return false;
    SessionSettings settings;
    settings.track = true;
    settings.map = true;
    Rigid3 camera_from_body = Rigid3::Identity();
    camera_from_body.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // Z up in the picture
    camera_from_body.translation() = Eigen::Vector3d(-0.15, 0.15, 0.6);
    loop.emplace(std::move(FrameLoop::make(test::DentedSphere{}.body(), camera_from_body,
                                           test::wall_format(), settings)
                               .value()));
    map.emplace(value_or_throw(MapRenderer::make()), loop->session.body().world_from_body);
    return true;
  }
  void show(const Frame& frame) {
    const Scene& scene = loop->process(frame);
    inside = ColorImage(644, 484, Rgb{0, 255, 0});  // large enough for what is written in it
    const Session& session = loop->session;
    map->draw(scene, session, 1e4, ColorScale::kBlueYellow, inside, picture);
  }
  void show(double x) { show(test::frame_of_wall(number++, x)); }
  void show_dark() {
    Frame frame = test::frame_of_wall(number++, 0);
    std::fill(frame.left.begin(), frame.left.end(), Rgb{});
    show(frame);
  }
  template <class Is>
  [[nodiscard]] long count(const Is& is) const {
    return std::count_if(picture.begin(), picture.end(), is);
  }
};

bool is_blue(Rgb c) { return c.b > 150 && c.b > c.g + 60 && c.b > c.r + 90; }
bool is_red(Rgb c) { return c.r > 205 && c.g < 60 && c.b < 60; }
bool is_warning(Rgb c) { return c.r > 150 && c.r < 200 && c.g < 70 && c.b < 70; }
bool is_orange(Rgb c) { return c.r > 200 && c.g > 110 && c.g < 190 && c.b < 100; }
// Whether a pixel shows the wall; the background is lighter and slightly blue.
bool is_grey(Rgb c) { return c.r == c.g && c.g == c.b && c.r < 225; }

#define PALPABLE_NEEDS_OUTSIDE(name) \
  Outside name;                      \
  if (!name.ready()) PALPABLE_SKIP(name.context.problem().message)

TEST_CASE("the picture of the map shows room, way and camera, and what the camera sees",
          "[view][map_picture]") {
  PALPABLE_NEEDS_OUTSIDE(out);
  for (int n = 0; n < 3; ++n) out.show(0.0);
  REQUIRE(out.picture.width() == 644);
  REQUIRE(out.picture.height() == 484);
  const long grey = out.count(is_grey);
  const long blue = out.count(is_blue);  // the body's; the camera has stood so far
  CHECK(out.count(is_orange) > 10);
  for (int n = 0; n < 40; ++n) out.show(0.004 * n);
  for (int n = 0; n < 20; ++n) out.show(0.156);
  REQUIRE(out.loop->session.slam().tracker()->counts().lost == 0);
  CHECK(out.count(is_grey) > grey + 300);
  CHECK(out.count(is_blue) > blue + 20);
  CHECK(out.count(is_orange) > 10);
  CHECK(out.count(is_red) == 0);
  const auto green = [](Rgb c) { return c == Rgb{0, 255, 0}; };
  CHECK(out.count(green) == 161 * 121);
  CHECK(out.context.value().errors().count() == 0);
}

TEST_CASE("a lost camera stands red in the picture of the map", "[view][map_picture]") {
  PALPABLE_NEEDS_OUTSIDE(out);
  for (const double x : {0.0, 0.0, 0.01, 0.02, 0.03, 0.02, 0.01, 0.0}) out.show(x);
  CHECK(out.count(is_red) == 0);
  REQUIRE(out.count(is_orange) > 10);
  out.show_dark();
  REQUIRE(out.loop->scene.camera.state == TrackState::kLost);
  CHECK(out.count(is_red) > 10);  // not the warning's: its red is darker
  CHECK(out.count(is_orange) == 0);
  CHECK(out.count(is_warning) > 1000);
  out.show(0.0);
  out.show(0.0);
  REQUIRE(is_known(out.loop->scene.camera));
  CHECK(out.count(is_red) == 0);
  CHECK(out.count(is_warning) == 0);
}

TEST_CASE("a lost camera is said to be lost, a found one is not", "[view][scene_picture]") {
  Scene scene;
  scene.time = 1.5;
  scene.camera.state = TrackState::kTracking;
  CHECK(caption_of(scene) == "1.50 s");
  CHECK(warning_of(scene).empty());
  scene.camera.state = TrackState::kLost;
  CHECK(caption_of(scene) == "1.50 s");
  CHECK(warning_of(scene).find("not placed yet") != std::string::npos);
  scene.camera.newest_keyframe = 0;
  CHECK(warning_of(scene).find("lost") != std::string::npos);
  scene.camera.state = TrackState::kTracking;
  scene.camera.since_new_world = 2;
  CHECK(warning_of(scene).find("New surroundings") != std::string::npos);
  scene.camera.since_new_world = 6;
  CHECK(warning_of(scene).empty());
}

TEST_CASE("the caption says how deep and how hard, and how many touches there are",
          "[view][scene_picture]") {
  Scene scene;
  scene.time = 2;
  Touch touch;
  touch.press_depth = 0.004;
  touch.force = 1.5;
  scene.touches = {touch};
  CHECK(caption_of(scene) == "2.00 s   4.0 mm   1.50 N");
  touch.press_depth = 0.006;
  scene.touches.push_back(touch);
  CHECK(caption_of(scene) == "2.00 s   2 touches   deepest 6.0 mm   3.00 N in all");
  touch.site = 7;
  scene.touches = {touch};
  CHECK(caption_of(scene) == "2.00 s   site 7   6.0 mm   1.50 N");
  scene.bodies.resize(2);
  scene.bodies[1].stated_error = StatedError{.displacement = 0.0213, .von_mises = 0.07};
  CHECK(caption_of(scene) ==
        "2.00 s   site 7   6.0 mm   1.50 N   model error \u00b12.1 %, stress \u00b17 %");
  scene.bodies[1].stated_error = StatedError{.displacement = 0.76, .von_mises = 2.64};
  CHECK(caption_of(scene).find("model error \u00b176 %, stress > 100 %") != std::string::npos);
  scene.bodies[0].hidden_since_start = 0.04;
  CHECK(caption_of(scene).find("hidden") == std::string::npos);
  scene.bodies[0].hidden_since_start = 0.314;
  scene.touches.clear();
  CHECK(caption_of(scene) == "2.00 s   31 % hidden since the start, not felt there");
}

TEST_CASE("a warning on the picture says that a touch is held without being seen",
          "[view][scene_picture]") {
  Scene scene;
  scene.camera.state = TrackState::kTracking;
  scene.touches.resize(2);
  CHECK(warning_of(scene).empty());
  scene.touches[1].unseen_for = 0.1;
  CHECK(warning_of(scene).find("not seen") != std::string::npos);
  scene.touches.clear();
  scene.seen.trouble = DepthTrouble::kRowsOff;
  scene.seen.row_error_px = -1.26;
  CHECK(warning_of(scene).find("rows are 1.3 px out of line") != std::string::npos);
  scene.seen.trouble = DepthTrouble::kFewDepths;
  scene.seen.density = 0.031;
  CHECK(warning_of(scene).find("Depth in 3 % of the picture only") != std::string::npos);
}

TEST_CASE("a scan has a picture without a path, too: before a bare wall the camera is not tracked",
          "[view][map_picture]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  MapRenderer renderer = value_or_throw(MapRenderer::make());
  MapMesh wall;
  wall.vertices.resize(3, 4);
  wall.vertices << -1, 1, 1, -1, -1, -1, 1, 1, 2, 2, 2, 2;
  wall.normals = Eigen::Vector3f(0, 0, -1).replicate<1, 4>();
  wall.triangles.resize(3, 2);
  wall.triangles << 0, 0, 2, 3, 1, 2;
  wall.colors.assign(4, Rgb{90, 90, 90});
  const ColorImage picture =
      picture_of_scan(renderer, wall, CameraPath{}, {}, test::wall_format().depth_camera);
  CHECK(std::count_if(picture.begin(), picture.end(), is_grey) > 10000);
}

}  // namespace
}  // namespace palpable
