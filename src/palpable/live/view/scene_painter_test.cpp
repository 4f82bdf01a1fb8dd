#include "palpable/live/view/scene_painter.h"

#include "palpable/live/session/frame_loop.h"
#include "tests/support/allocations.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/seen_wall.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace palpable {
namespace {

FrameLoop loop_before_sphere() {
  Rigid3 camera_from_body = Rigid3::Identity();
  camera_from_body.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // Z up in the picture
  camera_from_body.translation() = Eigen::Vector3d(0, 0.05, 0.4);
  return value_or_throw(FrameLoop::make(test::DentedSphere{}.body(), camera_from_body,
                                        test::wall_format(), {.press_static = true, .map = false}));
}

std::optional<ScenePainter> painter_of(const ScenePainterSettings& settings,
                                       const FrameLoop& loop) {
  try {
    return std::optional<ScenePainter>(std::in_place, settings, loop);
  } catch (const Error&) { return std::nullopt; }  // no OpenGL
}

TEST_CASE("masks are filled in only on request, and the picture is the same without them",
          "[view][pixels]") {
  FrameLoop loop = loop_before_sphere();
  DrawnFrame with, without;
  with.scene = loop.process(test::frame_of_wall(0, 0));
  without.scene = with.scene;
  {
    std::optional<ScenePainter> painter = painter_of({}, loop);
    if (!painter) PALPABLE_SKIP("no OpenGL");
    painter->draw(with, loop.session);
  }
  std::optional<ScenePainter> painter = painter_of({.masks = false}, loop);
  REQUIRE(painter.has_value());
  painter->draw(without, loop.session);
  CHECK(std::count(with.visible.begin(), with.visible.end(), std::uint8_t{255}) > 1000);
  CHECK(with.body_depth.width() == with.picture.width());
  CHECK(without.visible.empty());
  CHECK(without.body_depth.empty());
  CHECK(without.picture == with.picture);
}

// The number of allocations when a scene that nothing touches is drawn again.
int allocations_of_redrawing(ScenePainter& painter, FrameLoop& loop) {
  DrawnFrame drawn;
  drawn.scene = loop.process(test::frame_of_wall(0, 0));
  drawn.scene.touches.clear();
  const auto draw = [&] { painter.draw(drawn, loop.session); };
  draw();
  return test::allocations_during(draw);
}

TEST_CASE("a scene that nothing touches is drawn again without taking memory", "[view][pixels]") {
  FrameLoop loop = loop_before_sphere();
  std::optional<ScenePainter> painter = painter_of({}, loop);
  if (!painter) PALPABLE_SKIP("no OpenGL");
  CHECK(allocations_of_redrawing(*painter, loop) == 0);
}

TEST_CASE("components are wanted where they are painted, and painting them takes no memory again",
          "[view][pixels]") {
  FrameLoop loop = loop_before_sphere();
  SceneShow show;
  show.field = SceneShow::Field::kPressure;
  std::optional<ScenePainter> painter = painter_of({.show = show}, loop);
  if (!painter) PALPABLE_SKIP("no OpenGL");
  CHECK(painter->wants() == SceneExtras{.components = true});
  painter->controls().next_field();
  CHECK(painter->wants() == SceneExtras{.components = true});  // a component
  painter->controls().next_field();
  CHECK(painter->wants() == SceneExtras{.contact_pressure = true});
  painter->controls().next_field();
  CHECK(painter->wants() == SceneExtras{});
  painter->controls().paused = true;  // the held scene may be painted with any field
  CHECK(painter->wants() == SceneExtras{.components = true, .contact_pressure = true});
  painter->controls().paused = false;

  painter->controls().reset();
  loop.session.keep(painter->wants());
  CHECK(allocations_of_redrawing(*painter, loop) == 0);
}

TEST_CASE("a frame that is in no file and in no window is not drawn", "[view][pixels]") {
  FrameLoop loop = loop_before_sphere();
  std::optional<ScenePainter> painter = painter_of({}, loop);
  if (!painter) PALPABLE_SKIP("no OpenGL");
  DrawnFrame drawn;
  drawn.scene = loop.process(test::frame_of_wall(0, 0));
  drawn.in_files = false;
  painter->draw(drawn, loop.session);
  CHECK(drawn.picture.empty());
  CHECK(drawn.scene.times.ms("draw") == 0);
  SECTION("but for a page, which does not wait for the disk") {
    CHECK(painter->draw(drawn, loop.session, false, true));
    CHECK_FALSE(drawn.picture.empty());
    return;
  }
  drawn.in_files = true;
  painter->draw(drawn, loop.session);
  CHECK_FALSE(drawn.picture.empty());
}

}  // namespace
}  // namespace palpable
