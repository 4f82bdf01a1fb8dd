#include "palpable/live/sources/paced_source.h"

#include "tests/support/misbehaving_camera.h"
#include "tests/support/test.h"

#include <memory>
#include <vector>

namespace palpable {
namespace {

using test::Act;
using test::MisbehavingCamera;

/// A clock that advances only by sleep() or by the test.
class HandClock final : public WallClock {
 public:
  double now() override { return time; }
  void sleep(double seconds) override { time += seconds; }
  double time = 1000;
};

TEST_CASE("a reader in time gets every frame, and not before it is due", "[sources][paced]") {
  HandClock clock;
  const auto source =
      paced(std::make_unique<MisbehavingCamera>(std::vector<Act>(10, Act::kGood)), clock);
  CHECK(source->is_live());
  Frame frame;
  const double begin = clock.time;
  for (int i = 0; i < 10; ++i) {
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.number == i);
    CHECK(clock.time - begin == Approx(i / 30.0));
    CHECK(source->taken().value() == Approx(clock.time));
  }
  CHECK(source->next(frame) == FrameStatus::kEnd);
}

TEST_CASE("a late reader gets the newest frame that is due", "[sources][paced]") {
  HandClock clock;
  const auto source =
      paced(std::make_unique<MisbehavingCamera>(std::vector<Act>(30, Act::kGood)), clock);
  Frame frame;
  const double begin = clock.time;
  std::vector<int> numbers;
  while (source->next(frame) == FrameStatus::kFrame) {
    CHECK(source->taken().value() - begin == Approx(frame.number / 30.0).margin(1e-9));  // due
    numbers.push_back(frame.number);
    clock.time += 0.105;  // a little more than three frames
  }
  CHECK(numbers == std::vector<int>{0, 3, 6, 9, 12, 15, 18, 22, 25, 28, 29});
}

TEST_CASE("a late reader that may miss nothing gets every frame, none before it is due",
          "[sources][paced]") {
  HandClock clock;
  const auto source = paced(std::make_unique<MisbehavingCamera>(std::vector<Act>(12, Act::kGood)),
                            clock, Late::kKept);
  CHECK_FALSE(source->is_live());
  Frame frame;
  const double begin = clock.time;
  for (int i = 0; i < 12; ++i) {
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.number == i);
    CHECK(clock.time - begin >= i / 30.0 - 1e-9);
    clock.time += i < 6 ? 0.105 : 0;
  }
  CHECK(source->next(frame) == FrameStatus::kEnd);
}

TEST_CASE("an unreadable frame is told, and a long wait is cut into short ones",
          "[sources][paced]") {
  HandClock clock;
  std::vector<Act> acts{Act::kGood, Act::kGarbage};
  acts.insert(acts.end(), 9, Act::kDrop);  // no frames for a third of a second
  acts.push_back(Act::kGood);
  const auto source = paced(std::make_unique<MisbehavingCamera>(acts), clock);
  Frame frame;
  CHECK(source->next(frame) == FrameStatus::kFrame);
  CHECK(source->next(frame) == FrameStatus::kUnreadable);
  CHECK(frame.number == 1);
  int waits = 0;
  while (source->next(frame) == FrameStatus::kWaiting) ++waits;
  CHECK(waits == 3);
  CHECK(frame.number == 11);
}

TEST_CASE("a time from the far future or none at all holds nothing up", "[sources][paced]") {
  for (const Act act : {Act::kFarFuture, Act::kNoTime, Act::kLateClock}) {
    HandClock clock;
    std::vector<Act> acts(9, Act::kGood);
    acts[3] = act;
    const auto source = paced(std::make_unique<MisbehavingCamera>(acts), clock);
    const double begin = clock.time;
    Frame frame;
    int frames = 0;
    for (int calls = 0; calls < 100; ++calls) {
      if (source->next(frame) == FrameStatus::kFrame) ++frames;
    }
    CHECK(frames >= 8);  // if two frames are due at once, the newer is returned
    CHECK(frame.number == 8);
    CHECK(clock.time - begin < 4);
  }
}

}  // namespace
}  // namespace palpable
