#include "palpable/live/player/vision_thread.h"

#include "palpable/live/session/frame_loop.h"
#include "palpable/live/sources/wall_clock.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/test.h"

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

/// A finger that penetrates a sphere 0.4 m away more in every frame; every fifth image is damaged.
class FingerSource : public FrameSource {
 public:
  FingerSource() {
    format_.kind = FrameFormat::Kind::kColorDepth;
    format_.width = 161;
    format_.height = 121;
    format_.depth_camera = {161, 121, 250, 250, 80, 60};
  }
  const FrameFormat& format() const override { return format_; }
  FrameStatus next(Frame& frame) override {
    if (number_ >= fails_at) throw std::runtime_error("the cable came off");
    if (number_ >= 20) return FrameStatus::kEnd;
    frame.number = number_++;
    frame.time = frame.number / 30.0;
    if (frame.number % 5 == 4) return FrameStatus::kUnreadable;
    const double y = -0.062 + 0.001 * frame.number;
    frame.left = ColorImage(161, 121, Rgb{50, 60, 70});
    frame.depth = test::depth_of({{{0, y, 0.4}, {0, y - 0.1, 0.38}, 0.009}}, format_.depth_camera);
    return FrameStatus::kFrame;
  }
  int frame_count() const override { return 20; }
  std::string last_trouble() const override { return "damaged"; }
  std::optional<double> taken() const override { return is_taken; }

  int fails_at = 1000;
  std::optional<double> is_taken;

 private:
  FrameFormat format_;
  int number_ = 0;
};

// A sphere of radius 5 cm and centre (0, 0, 0.4) m, its top towards the camera's -Y.
FrameLoop loop_for(const FrameSource& source) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  pose.translation() = Eigen::Vector3d(0, 0.05, 0.4);
  return std::move(FrameLoop::make(test::DentedSphere{}.body(), pose, source.format(),
                                   {.press_static = true, .map = false})
                       .value());
}

TEST_CASE("seeing the next frame on another thread changes no result", "[player][threads]") {
  std::vector<Scene> expected;
  {
    FingerSource source;
    FrameLoop loop = loop_for(source);
    Frame frame;
    for (FrameStatus status = source.next(frame); status != FrameStatus::kEnd;
         status = source.next(frame)) {
      if (status == FrameStatus::kFrame) expected.push_back(loop.process(frame));
    }
  }
  REQUIRE(expected.size() == 16);
  REQUIRE(expected.back().touches.size() == 1);

  FingerSource source;
  FrameLoop loop = loop_for(source);
  VisionThread vision(source, loop.camera, -1);
  std::size_t n = 0;
  while (std::unique_ptr<FrameInFlight> flight = vision.next()) {
    REQUIRE(n < expected.size());
    loop.session.respond(flight->scene);
    const Scene& scene = flight->scene;
    CHECK(scene.number == expected[n].number);
    CHECK(scene.bodies[0].vertices == expected[n].bodies[0].vertices);
    CHECK(scene.bodies[0].von_mises == expected[n].bodies[0].von_mises);
    vision.recycle(std::move(flight));
    ++n;
  }
  CHECK(n == expected.size());
}

TEST_CASE("the loop may stop after some frames, or be left in the middle", "[player][threads]") {
  FingerSource source;
  FrameLoop loop = loop_for(source);
  {
    VisionThread vision(source, loop.camera, 3);
    int frames = 0;
    while (std::unique_ptr<FrameInFlight> flight = vision.next()) {
      vision.recycle(std::move(flight));
      ++frames;
    }
    CHECK(frames == 3);
  }
  VisionThread left_alone(source, loop.camera, -1);
  CHECK(left_alone.next() != nullptr);
}

TEST_CASE("what goes wrong while seeing is said to whoever waits for the frame",
          "[player][threads][errors]") {
  FingerSource source;
  source.fails_at = 2;
  FrameLoop loop = loop_for(source);
  VisionThread vision(source, loop.camera, -1);
  vision.recycle(vision.next());
  vision.recycle(vision.next());
  CHECK_THROWS_WITH(vision.next(), "the cable came off");
}

TEST_CASE("a camera that does everything wrong never stops the loop, and the last state is held",
          "[player][threads][errors]") {
  using test::Act;
  std::vector<Act> acts(8, Act::kGood);
  for (const Act bad : {Act::kStall, Act::kDrop, Act::kResize, Act::kNoDepth, Act::kGarbage,
                        Act::kNoise, Act::kNoTime, Act::kBackInTime, Act::kGone}) {
    acts.insert(acts.end(), 3, bad);
    acts.insert(acts.end(), 2, Act::kGood);
  }
  acts.push_back(Act::kNewClock);
  acts.insert(acts.end(), 9, Act::kGood);

  // Expected results: only the good frames, without the vision thread.
  std::vector<Scene> expected;
  {
    test::MisbehavingCamera camera(acts);
    FrameLoop loop = loop_for(camera);
    SourceGuard guard(camera);
    Frame frame;
    for (FrameStatus status = guard.next(frame); status != FrameStatus::kEnd;
         status = guard.next(frame)) {
      if (status == FrameStatus::kFrame) expected.push_back(loop.process(frame));
    }
  }
  REQUIRE(expected.size() == 8 + 9 * 2 + 10 - (SourceGuard::kClockRestart - 1));
  REQUIRE(expected.back().touches.size() == 1);

  test::MisbehavingCamera camera(acts);
  FrameLoop loop = loop_for(camera);
  VisionThread vision(camera, loop.camera, -1);
  std::size_t n = 0;
  std::vector<std::string> reports;
  while (!vision.ended()) {
    std::unique_ptr<FrameInFlight> flight = vision.next_within(0.001);
    for (std::string& line : vision.take_reports().lines) reports.push_back(std::move(line));
    if (!flight) continue;  // the previous picture stays on the screen
    REQUIRE(n < expected.size());
    loop.session.respond(flight->scene);
    const Scene& scene = flight->scene;
    CHECK(scene.number == expected[n].number);
    CHECK(scene.bodies[0].vertices == expected[n].bodies[0].vertices);
    CHECK(scene.touches.size() == expected[n].touches.size());
    // After the first touch every frame has the touch: the finger never leaves.
    if (n > 0 && !expected[n - 1].touches.empty()) CHECK(scene.touches.size() == 1);
    vision.recycle(std::move(flight));
    ++n;
  }
  CHECK(n == expected.size());
  const SourceTroubles troubles = vision.take_reports().troubles;
  CHECK(troubles.unreadable == 6 * 3 + SourceGuard::kClockRestart - 1);
  CHECK(troubles.dropped == 3);
  CHECK(troubles.stalls == 1);
  CHECK(troubles.losses == 1);
  CHECK(troubles.back_in_time == 3 + SourceGuard::kClockRestart - 1);
  // Six kinds of bad frames, the new clock's first outdated frames and its restart, stall, loss,
  // and twice "come again".
  CHECK(reports.size() == 6 + 2 + 4);
}

TEST_CASE("the loop can be left while a camera is silent", "[player][threads]") {
  test::MisbehavingCamera camera({test::Act::kStall});
  camera.repeats_last = true;
  FrameLoop loop = loop_for(camera);
  VisionThread vision(camera, loop.camera, -1);
  CHECK(vision.next_within(0.001) == nullptr);
  CHECK_FALSE(vision.ended());
}

TEST_CASE("a frame was taken when its source says so, or when it came where that makes no sense",
          "[player]") {
  const double begin = system_clock().now();
  const auto first_taken = [](std::optional<double> taken) {
    FingerSource source;
    source.is_taken = taken;
    FrameLoop loop = loop_for(source);
    VisionThread vision(source, loop.camera, 1);
    return vision.next()->taken;
  };
  CHECK(first_taken(begin - 0.5) == begin - 0.5);
  // A recording does not say; a driver's clock may count from 1970, or from when it was loaded.
  for (const std::optional<double> odd : {std::optional<double>(), {1.8e9}, {begin - 1000}}) {
    const double taken = first_taken(odd);
    CHECK(taken >= begin);
    CHECK(taken <= system_clock().now());
  }
}

}  // namespace
}  // namespace palpable
