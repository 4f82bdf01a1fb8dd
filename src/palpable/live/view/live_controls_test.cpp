#include "palpable/live/view/live_controls.h"

#include "tests/support/test.h"

#include <set>
#include <string>

namespace palpable {
namespace {

WindowEvent typed(int key) {
  WindowEvent event;
  event.kind = WindowEvent::Kind::kKey;
  event.key = key;
  return event;
}

void type(LiveControls& controls, const std::string& keys) {
  for (const char key : keys) controls.handle(typed(key));
}

TEST_CASE("keys switch what is shown, and R takes all of it back", "[view][live_controls]") {
  SceneShow first;
  first.forces = true;
  LiveControls controls(LiveView::kMap, first, 3);
  const struct {
    int key;
    LiveView view;
  } views[] = {{'1', LiveView::kCamera},  {'2', LiveView::kDepth}, {'3', LiveView::kMoving},
               {'4', LiveView::kSurface}, {'5', LiveView::kMap},   {'6', LiveView::kMap}};
  for (const auto& [key, view] : views) {
    controls.handle(typed(key));
    CHECK(controls.view == view);
  }
  type(controls, "1FOCNLB");
  CHECK(controls.show.field == SceneShow::Field::kPressure);
  CHECK(controls.show.occlusion != first.occlusion);
  CHECK(controls.show.contacts != first.contacts);
  CHECK(controls.show.forces != first.forces);
  CHECK(controls.show.legend != first.legend);
  CHECK(controls.body == 0);
  controls.handle(typed('R'));
  CHECK(controls.view == LiveView::kMap);
  CHECK(controls.show == first);
  CHECK(controls.body == -1);
}

TEST_CASE("what has several values comes round to the first one", "[view][live_controls]") {
  LiveControls controls(LiveView::kCamera, {}, 2);
  type(controls, std::string(kFieldNames.size(), 'F') + std::string(kOcclusionNames.size(), 'O'));
  CHECK(controls.show == SceneShow{});
  type(controls, "BB");
  CHECK(controls.body == 1);
  type(controls, "B");
  CHECK(controls.body == -1);
  LiveControls one(LiveView::kCamera, {}, 1);  // there is nothing to choose
  type(one, "B");
  CHECK(one.body == -1);
}

TEST_CASE("a step pauses first, and goes on by a frame then", "[view][live_controls]") {
  LiveControls controls(LiveView::kCamera, {}, 1);
  type(controls, "S");
  CHECK(controls.paused);
  CHECK_FALSE(controls.step_wanted);
  type(controls, "S");
  CHECK(controls.paused);
  CHECK(controls.step_wanted);
  controls.step_wanted = false;
  type(controls, " ");
  CHECK_FALSE(controls.paused);
}

WindowEvent clicked(double x, double y, int button = 0) {
  WindowEvent event;
  event.kind = WindowEvent::Kind::kPress;
  event.x_px = x;
  event.y_px = y;
  event.button = button;
  return event;
}

TEST_CASE("a click says where a body stands only after A, where the camera's pixels are seen",
          "[view][live_controls]") {
  LiveControls controls(LiveView::kMap, {}, 1);
  controls.run_may_change = true;
  controls.handle(clicked(10, 20));
  CHECK_FALSE(controls.wishes.place);
  type(controls, "A");
  CHECK(controls.placing);
  CHECK(controls.view == LiveView::kCamera);
  type(controls, "5");
  controls.handle(clicked(10, 20));  // that turns the map
  CHECK_FALSE(controls.wishes.place);
  type(controls, "2");
  controls.handle(clicked(30, 40, 1));
  CHECK_FALSE(controls.wishes.place);
  controls.handle(clicked(30, 40));
  REQUIRE(controls.wishes.place);
  CHECK(*controls.wishes.place == Eigen::Vector2d(30, 40));
  CHECK(controls.wishes.of_frame());
  CHECK_FALSE(controls.placing);
  controls.wishes = {};
  controls.handle(clicked(50, 60));  // one A, one place
  CHECK_FALSE(controls.wishes.place);
  // Escape cancels the A; the next Escape ends the run.
  type(controls, "A");
  controls.handle(typed(WindowEvent::kEscape));
  CHECK_FALSE(controls.placing);
  CHECK_FALSE(controls.ended);
  controls.handle(typed(WindowEvent::kEscape));
  CHECK(controls.ended);
}

TEST_CASE("a run is changed only if it may be changed", "[view][live_controls]") {
  for (const bool may_change : {true, false}) {
    INFO("may change: " << may_change);
    LiveControls controls(LiveView::kCamera, {}, 1);
    controls.run_may_change = may_change;
    type(controls, "E");
    CHECK(controls.wishes.anew == may_change);
    CHECK(controls.wishes.of_frame() == may_change);
    controls.wishes = {};
    type(controls, "V");
    CHECK(controls.wishes.recording == may_change);
    CHECK_FALSE(controls.wishes.of_frame());
    type(controls, "A");
    CHECK(controls.placing == may_change);
  }
}

TEST_CASE("H shows the keys where they can be read, and each key once", "[view][live_controls]") {
  LiveControls controls(LiveView::kCamera, {}, 1);
  type(controls, "TH");
  CHECK(controls.help_shown);
  CHECK(controls.panel_shown);
  type(controls, "H");
  CHECK_FALSE(controls.help_shown);
  CHECK(controls.panel_shown);
  type(controls, "PQ");
  CHECK(controls.picture_wanted);
  CHECK(controls.ended);
  std::set<std::string> keys;
  for (const LiveKey& key : LiveControls::keys()) CHECK(keys.insert(key.key).second);
}

}  // namespace
}  // namespace palpable
