#include "palpable/live/render/window_events.h"

#include "tests/support/test.h"

#include <vector>

namespace palpable {
namespace {

using Kind = WindowEvent::Kind;

TEST_CASE("a picture fills its window as far as its proportions allow, in the middle",
          "[render][window_events]") {
  const auto at = [](int window_width, int window_height) {
    const auto place = place_picture(320, 200, window_width, window_height);
    REQUIRE(place);
    return std::vector<int>{place->x, place->y, place->width, place->height};
  };
  CHECK(at(320, 200) == std::vector<int>{0, 0, 320, 200});
  CHECK(at(640, 400) == std::vector<int>{0, 0, 640, 400});
  CHECK(at(640, 200) == std::vector<int>{160, 0, 320, 200});
  CHECK(at(320, 600) == std::vector<int>{0, 200, 320, 200});
  CHECK(at(1, 500) == std::vector<int>{0, 249, 1, 1});  // 0.6 px high
}

TEST_CASE("a window without area, as a minimised one, shows its picture nowhere",
          "[render][window_events]") {
  CHECK_FALSE(place_picture(320, 200, 0, 0));
  CHECK_FALSE(place_picture(320, 200, 0, 300));
  CHECK_FALSE(place_picture(320, 200, 300, 0));
}

TEST_CASE("events are where the picture is, whatever the size of the window",
          "[render][window_events]") {
  WindowEventLog log;
  log.shows(320, 200);
  log.resized(800, 400);  // the picture at 80, 0, twice as large
  log.moved(80, 0);
  log.moved(80 + 640, 400);
  log.moved(0, 0);
  const auto events = log.take();
  REQUIRE(events.size() == 3);
  CHECK(events[0].x_px == -0.5);
  CHECK(events[0].y_px == -0.5);
  CHECK(events[1].x_px == 319.5);
  CHECK(events[1].y_px == 199.5);
  CHECK(events[2].x_px == -40.5);  // beside it
}

TEST_CASE("a press and a drag between two frames are where each of them happened",
          "[render][window_events]") {
  WindowEventLog log;
  log.shows(320, 200);
  log.resized(320, 200);
  log.moved(40, 30);
  log.button(0, true);
  log.moved(140, 30);
  log.button(0, false);
  log.wheel(-1);
  log.key('P');
  CHECK_FALSE(log.empty());
  const auto events = log.take();
  REQUIRE(events.size() == 6);
  CHECK(events[1].kind == Kind::kPress);
  CHECK(events[1].x_px == 39.5);
  CHECK(events[2].kind == Kind::kMove);
  CHECK(events[2].x_px == 139.5);
  CHECK(events[3].kind == Kind::kRelease);
  CHECK(events[3].x_px == 139.5);
  CHECK(events[4].wheel == -1);
  CHECK(events[5].key == 'P');
  CHECK(log.empty());
  CHECK(log.take().empty());
}

TEST_CASE("a window that is minimised during a drag leaves finite positions",
          "[render][window_events]") {
  WindowEventLog log;
  log.shows(320, 200);
  log.resized(640, 400);
  log.moved(100, 100);
  log.button(0, true);
  log.resized(0, 0);
  log.button(0, false);
  log.shows(160, 100);  // another picture is shown in between
  log.moved(100, 100);
  const auto events = log.take();
  REQUIRE(events.size() == 4);
  CHECK(events[2].kind == Kind::kRelease);
  CHECK(events[2].x_px == 49.5);
  CHECK(events[3].x_px == 24.5);
}

}  // namespace
}  // namespace palpable
