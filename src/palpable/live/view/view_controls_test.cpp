#include "palpable/live/view/view_controls.h"

#include "tests/support/test.h"

#include <optional>

namespace palpable {
namespace {

using Kind = WindowEvent::Kind;

const OrbitCamera kUsual{{0, 0, 0.07}, 0.3, 0.4, 0.6};

WindowEvent mouse(Kind kind, double x, double y, int button = 0) {
  WindowEvent event;
  event.kind = kind;
  event.x_px = x;
  event.y_px = y;
  event.button = button;
  return event;
}

WindowEvent typed(int key) {
  WindowEvent event;
  event.kind = Kind::kKey;
  event.key = key;
  return event;
}

/// A body that covers x < 100 px; the site is x / 10.
std::optional<int> site_at(double x, double /*y*/) {
  return x < 100 ? std::optional<int>(static_cast<int>(x) / 10) : std::nullopt;
}

TEST_CASE("holding the button on the body presses deeper and deeper, to the full load and no more",
          "[view][view_controls]") {
  ViewControls controls(kUsual);
  CHECK(controls.level(0) == 0);
  CHECK_FALSE(controls.moving(0));
  controls.handle(mouse(Kind::kPress, 42, 10), 1.0, site_at);
  CHECK(controls.site() == 4);
  double before = -1;
  for (const double t : {1.0, 1.2, 1.5, 1.9, 2.1}) {
    CHECK(controls.level(t) > before);
    before = controls.level(t);
  }
  CHECK(controls.level(1.0) == 0);
  CHECK(controls.moving(2.1));
  CHECK(controls.level(5.0) == 1);
  CHECK_FALSE(controls.moving(5.0));  // nothing to draw until the user does something
}

TEST_CASE("dragging presses too, and the camera stays where it is", "[view][view_controls]") {
  ViewControls controls(kUsual);
  controls.handle(mouse(Kind::kPress, 42, 10), 1.0, site_at);
  controls.handle(mouse(Kind::kMove, 42, 150), 1.0, site_at);
  CHECK(controls.level(1.0) == Approx(0.5));
  CHECK(controls.site() == 4);
  CHECK(controls.camera.azimuth == kUsual.azimuth);
  CHECK(controls.camera.elevation == kUsual.elevation);
}

TEST_CASE("what is let go springs back without overshoot and comes to rest",
          "[view][view_controls]") {
  ViewControls controls(kUsual);
  controls.handle(mouse(Kind::kPress, 5, 5), 1.0, site_at);
  controls.handle(mouse(Kind::kRelease, 5, 5), 1.6, site_at);
  CHECK(controls.level(1.6) == Approx(0.5));
  double before = 1;
  for (int i = 0; i < 100; ++i) {
    const double level = controls.level(1.6 + 0.005 * i);
    CHECK((level >= 0 && level <= before));
    before = level;
  }
  CHECK(controls.level(1.65) > 0.1);
  CHECK(controls.level(2.1) == 0);
  CHECK_FALSE(controls.moving(2.1));
}

TEST_CASE("dragging beside the body, or with another button, turns", "[view][view_controls]") {
  for (const bool beside : {true, false}) {
    ViewControls controls(kUsual);
    const double x = beside ? 200 : 50;
    const int button = beside ? 0 : 1;
    controls.handle(mouse(Kind::kPress, x, 5, button), 1.0, site_at);
    controls.handle(mouse(Kind::kMove, x + 20, 5), 1.1, site_at);
    CHECK(controls.camera.azimuth < kUsual.azimuth);
    CHECK(controls.level(2.0) == 0);
    const OrbitCamera turned = controls.camera;
    controls.handle(mouse(Kind::kRelease, x + 20, 5, button), 1.2, site_at);
    controls.handle(mouse(Kind::kMove, x + 90, 80), 1.3, site_at);
    CHECK(controls.camera.azimuth == turned.azimuth);
    controls.handle(typed('R'), 1.4, site_at);
    CHECK(controls.camera.azimuth == kUsual.azimuth);
  }
}

TEST_CASE("a press, a drag and a release within one frame press the body where they began",
          "[view][view_controls]") {
  ViewControls controls(kUsual);
  controls.handle(mouse(Kind::kPress, 42, 10), 1.0, site_at);
  controls.handle(mouse(Kind::kMove, 42, 150), 1.0, site_at);
  controls.handle(mouse(Kind::kRelease, 182, 10), 1.0, site_at);
  CHECK(controls.site() == 4);
  CHECK(controls.level(1.0) == Approx(0.5));  // and springs back from there
  CHECK(controls.moving(1.0));
}

TEST_CASE("a second button neither ends the first one's press nor turns", "[view][view_controls]") {
  ViewControls controls(kUsual);
  controls.handle(mouse(Kind::kPress, 42, 10), 1.0, site_at);
  controls.handle(mouse(Kind::kPress, 42, 10, 1), 1.1, site_at);
  controls.handle(mouse(Kind::kMove, 42, 80), 1.2, site_at);
  controls.handle(mouse(Kind::kRelease, 42, 80, 1), 1.3, site_at);
  CHECK(controls.camera.elevation == kUsual.elevation);
  CHECK(controls.moving(1.4));
  CHECK(controls.level(1.5) > controls.level(1.4));
  CHECK(controls.level(5.0) == 1);
  controls.handle(mouse(Kind::kRelease, 42, 80), 5.0, site_at);
  CHECK(controls.level(6.0) == 0);
}

TEST_CASE("while one button turns, another one does not press", "[view][view_controls]") {
  ViewControls controls(kUsual);
  controls.handle(mouse(Kind::kPress, 200, 10, 1), 1.0, site_at);
  controls.handle(mouse(Kind::kPress, 42, 10, 0), 1.1, site_at);
  CHECK(controls.level(3.0) == 0);
  controls.handle(mouse(Kind::kRelease, 42, 10, 0), 1.2, site_at);
  controls.handle(mouse(Kind::kMove, 62, 10), 1.3, site_at);
  CHECK(controls.camera.azimuth < kUsual.azimuth);  // still turning
}

TEST_CASE("a release that no press came before, as after a lost focus, changes nothing",
          "[view][view_controls]") {
  ViewControls controls(kUsual);
  controls.handle(mouse(Kind::kPress, 42, 10), 1.0, site_at);
  controls.handle(mouse(Kind::kRelease, 42, 10), 1.6, site_at);  // the window's, for the focus
  const double level = controls.level(1.65);
  controls.handle(mouse(Kind::kRelease, 42, 10), 1.64, site_at);  // the user's
  CHECK(controls.level(1.65) == level);
}

TEST_CASE("a note stays until a button or a key is pressed", "[view][view_controls]") {
  ViewControls controls(kUsual);
  for (const WindowEvent& next : {mouse(Kind::kPress, 200, 5), typed('S')}) {
    controls.note = "bunny_view_1.png";
    controls.handle(mouse(Kind::kMove, 200, 5), 1.0, site_at);
    controls.handle(mouse(Kind::kRelease, 200, 5), 1.0, site_at);
    CHECK(controls.note == "bunny_view_1.png");
    controls.handle(next, 1.0, site_at);
    CHECK(controls.note.empty());
  }
}

TEST_CASE("the wheel comes nearer and keys switch", "[view][view_controls]") {
  ViewControls controls(kUsual);
  WindowEvent wheel;
  wheel.kind = Kind::kWheel;
  wheel.wheel = 2;
  controls.handle(wheel, 0, site_at);
  CHECK(controls.camera.distance < kUsual.distance);
  controls.handle(typed('S'), 0, site_at);
  controls.handle(typed('L'), 0, site_at);
  controls.handle(typed('H'), 0, site_at);
  controls.handle(typed('P'), 0, site_at);
  CHECK(controls.sites_shown);
  CHECK_FALSE(controls.legend_shown);
  CHECK_FALSE(controls.help_shown);
  CHECK(controls.picture_wanted);
  CHECK_FALSE(controls.quit);
  controls.handle(typed(WindowEvent::kEscape), 0, site_at);
  CHECK(controls.quit);
}

TEST_CASE("a kept press stays until another begins", "[view][view_controls]") {
  ViewControls controls(kUsual);
  controls.keep(7, 0.6);
  CHECK(controls.level(100) == 0.6);
  CHECK(controls.site() == 7);
  CHECK_FALSE(controls.moving(100));
  controls.handle(mouse(Kind::kPress, 200, 5), 101, site_at);
  controls.handle(mouse(Kind::kRelease, 200, 5), 102, site_at);
  CHECK(controls.level(103) == 0.6);
  controls.handle(mouse(Kind::kPress, 12, 5), 104, site_at);
  CHECK(controls.site() == 1);
  CHECK(controls.level(104) == 0);
}

TEST_CASE("R paints again what was painted at the start", "[view][view_controls]") {
  ViewControls controls(kUsual, kPaints[4]);
  CHECK(controls.field == SceneShow::Field::kComponent);
  CHECK(controls.component == SceneShow::Component::kZz);
  controls.handle(typed('F'), 1, site_at);
  controls.component = SceneShow::Component::kXy;
  CHECK(controls.field == SceneShow::Field::kContact);
  controls.handle(typed('R'), 2, site_at);
  CHECK(controls.field == SceneShow::Field::kComponent);
  CHECK(controls.component == SceneShow::Component::kZz);
}

}  // namespace
}  // namespace palpable
