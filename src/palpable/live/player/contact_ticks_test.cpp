#include "palpable/live/player/contact_ticks.h"

#include "tests/support/pressed_sphere.h"
#include "tests/support/test.h"

#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

namespace palpable {
namespace {

struct Reported {
  int frame, number;
  double ahead, force;
  bool operator==(const Reported&) const = default;
};

// Records the ticks while a finger penetrates the sphere by 1 mm more in each frame.
struct Run {
  explicit Run(const ContactTicks::Settings& settings)
      : ticks(loop.session, settings, [this](const ContactTick& tick) {
          double force = 0;
          for (const Touch& touch : *tick.touches) force += touch.force;
          const std::lock_guard lock(mutex);
          reported.push_back({tick.frame, tick.number, tick.ahead, force});
        }) {}
  void frame(int number) {
    loop.process(test::frame_with_finger(number, 0.001 * number));
    ticks.end_frame();
    ticks.begin_frame(loop.session, loop.scene);
  }

  FrameLoop loop = test::touchable_sphere_loop();
  std::mutex mutex;
  std::vector<Reported> reported;
  ContactTicks ticks;  // last: its thread writes the members above
};

TEST_CASE("where frames wait, each has all its ticks, and they are the same each time",
          "[player][threads]") {
  Run one({.rate = 300}), again({.rate = 300});
  for (int n = 0; n < 6; ++n) {
    one.frame(n);
    again.frame(n);
  }
  const ContactTickFigures figures = one.ticks.finish();
  static_cast<void>(again.ticks.finish());
  REQUIRE(one.reported.size() == 60);
  CHECK(figures.ticks == 60);
  CHECK(figures.left_out == 0);
  for (int k = 0; k < 60; ++k) {
    const Reported& reported = one.reported[static_cast<std::size_t>(k)];
    CHECK(reported.frame == k / 10);
    CHECK(reported.number == k % 10 + 1);
    CHECK(reported.ahead == (k % 10 + 1) / 300.0);
  }
  CHECK(one.reported == again.reported);
  CHECK(one.reported.back().force > one.reported[50].force);  // the finger advances into the sphere
  CHECK(figures.frames > 0);
  CHECK(figures.off_held > 0);
  CHECK(figures.off < figures.off_held);
}

TEST_CASE("what is played live leaves out the ticks for which there was no time",
          "[player][threads]") {
  Run run({.rate = 300, .when_due = true});
  run.loop.process(test::frame_with_finger(0, 0.003));
  Scene scene = run.loop.scene;
  for (int n = 0; n < 100; ++n) {  // frames come faster than ticks are due
    scene.number = n;
    scene.time = n / 30.0;
    run.ticks.end_frame();
    run.ticks.begin_frame(run.loop.session, scene);
  }
  const ContactTickFigures figures = run.ticks.finish();
  CHECK(figures.ticks == run.reported.size());
  CHECK(figures.ticks < 1000);
  CHECK(figures.left_out > 0);
}

TEST_CASE("a late frame is waited for with ticks, for two intervals at most", "[player][threads]") {
  using namespace std::chrono_literals;
  Run run({.rate = 300, .when_due = true});
  run.frame(0);
  const auto count = [&] {
    const std::lock_guard lock(run.mutex);
    return run.reported.size();
  };
  const auto end = std::chrono::steady_clock::now() + 60s;
  while (count() < 20 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
  std::this_thread::sleep_for(20ms);
  static_cast<void>(run.ticks.finish());
  CHECK(run.reported.size() == 20);  // 2 intervals of 1/30 s at 300 Hz
}

}  // namespace
}  // namespace palpable
