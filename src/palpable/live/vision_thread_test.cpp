#include "palpable/live/vision_thread.h"

#include "palpable/live/bounded_queue.h"
#include "palpable/session/frame_loop.h"
#include "tests/support/allocations.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/test.h"

#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace palpable {
namespace {

/// A finger that sinks into a sphere 0.4 m away, frame by frame; every fifth image is damaged.
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

  int fails_at = 1000;

 private:
  FrameFormat format_;
  int number_ = 0;
};

// The sphere of 5 cm with its middle at (0, 0, 0.4), its top towards -Y of the camera.
FrameLoop loop_for(const FrameSource& source) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  pose.translation() = Eigen::Vector3d(0, 0.05, 0.4);
  return std::move(FrameLoop::make(test::DentedSphere{}.body(), pose, source.format()).value());
}

TEST_CASE("seeing the next frame on another thread changes no result", "[live][threads]") {
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
    CHECK(scene.vertices == expected[n].vertices);
    CHECK(scene.von_mises == expected[n].von_mises);
    vision.recycle(std::move(flight));
    ++n;
  }
  CHECK(n == expected.size());
}

TEST_CASE("the loop may stop after some frames, or be left in the middle", "[live][threads]") {
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
          "[live][threads][errors]") {
  FingerSource source;
  source.fails_at = 2;
  FrameLoop loop = loop_for(source);
  VisionThread vision(source, loop.camera, -1);
  vision.recycle(vision.next());
  vision.recycle(vision.next());
  CHECK_THROWS_WITH(vision.next(), "the cable came off");
}

TEST_CASE("a camera that does everything wrong never stops the loop, and the last state is held",
          "[live][threads][errors]") {
  using test::Act;
  std::vector<Act> acts(8, Act::kGood);
  for (const Act bad : {Act::kStall, Act::kDrop, Act::kResize, Act::kNoDepth, Act::kGarbage,
                        Act::kNoise, Act::kNoTime, Act::kBackInTime, Act::kGone}) {
    acts.insert(acts.end(), 3, bad);
    acts.insert(acts.end(), 2, Act::kGood);
  }
  acts.push_back(Act::kNewClock);
  acts.insert(acts.end(), 9, Act::kGood);

  // Only the good frames, without the loop: what the bad ones may not change.
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
    for (std::string& line : vision.take_reports()) reports.push_back(std::move(line));
    if (!flight) continue;  // the picture stays as it is
    REQUIRE(n < expected.size());
    loop.session.respond(flight->scene);
    const Scene& scene = flight->scene;
    CHECK(scene.number == expected[n].number);
    CHECK(scene.vertices == expected[n].vertices);
    CHECK(scene.touches.size() == expected[n].touches.size());
    // Once touched, touched through all of it: the finger never leaves.
    if (n > 0 && !expected[n - 1].touches.empty()) CHECK(scene.touches.size() == 1);
    vision.recycle(std::move(flight));
    ++n;
  }
  CHECK(n == expected.size());
  const SourceTroubles troubles = vision.troubles();
  CHECK(troubles.unreadable == 6 * 3 + SourceGuard::kClockRestart - 1);
  CHECK(troubles.dropped == 3);
  CHECK(troubles.stalls == 1);
  CHECK(troubles.losses == 1);
  CHECK(troubles.back_in_time == 3 + SourceGuard::kClockRestart - 1);
  // Six kinds of bad frames, the new clock's first old frames and its restart, stall, loss, and
  // twice "come again".
  CHECK(reports.size() == 6 + 2 + 4);
}

// What a frame is known to be of: compared between a loop with a thread and one without.
struct Known {
  int number = 0;
  TrackState state = TrackState::kStarting;
  Rigid3 world_from_camera;
  MaskImage moving;
};

Known known_of(const Scene& scene) {
  return {scene.number, scene.camera.state, scene.camera.world_from_camera, scene.moving};
}

TEST_CASE("through all of it the camera is followed, what moves is found and the map stays",
          "[live][threads][errors]") {
  using test::Act;
  for (const test::Shows shows : {test::Shows::kRoom, test::Shows::kStereoRoom}) {
    const bool stereo = shows == test::Shows::kStereoRoom;
    INFO((stereo ? "stereo" : "colour + depth"));
    std::vector<Act> acts(test::MisbehavingCamera::kAlone, Act::kGood);
    for (const Act bad :
         {Act::kStall, Act::kDrop, Act::kResize, Act::kGarbage, Act::kNoTime,
          stereo ? Act::kRightResize : Act::kNoDepth, Act::kBackInTime, Act::kGone}) {
      acts.insert(acts.end(), 3, bad);
      acts.insert(acts.end(), 3, Act::kGood);
    }
    acts.push_back(Act::kNewClock);
    acts.insert(acts.end(), 9, Act::kGood);

    const auto loop_of = [](const FrameSource& source) {
      Rigid3 far_aside = Rigid3::Identity();  // the body is not what is looked at here
      far_aside.translation() = Eigen::Vector3d(0.3, 0, 0.5);
      return std::move(FrameLoop::make(test::DentedSphere{}.body(), far_aside, source.format(),
                                       {.track = true, .map = true})
                           .value());
    };
    const Eigen::Vector3d on_wall(0, 0.03, test::kWallZ);

    std::vector<Known> expected;
    std::optional<double> expected_distance;
    {
      test::MisbehavingCamera camera(acts, shows);
      FrameLoop loop = loop_of(camera);
      SourceGuard guard(camera);
      Frame frame;
      for (FrameStatus status = guard.next(frame); status != FrameStatus::kEnd;
           status = guard.next(frame)) {
        if (status != FrameStatus::kFrame) continue;
        expected.push_back(known_of(loop.process(frame)));
        const Known& now = expected.back();
        INFO("frame " << now.number << " at " << camera.x() << " m");
        CHECK(now.state != TrackState::kLost);
        CHECK((now.world_from_camera.translation() - Eigen::Vector3d(camera.x(), 0, 0)).norm() <=
              test::tolerance(0.0016, "half a pixel of 250 on a wall 0.8 m away"));
        CHECK_FALSE(now.moving.empty());
      }
      // At the end the finger moves and what is far from it does not.
      const MaskImage& moving = expected.back().moving;
      const double scale = static_cast<double>(moving.width()) / camera.format().width;
      const auto at = [&](double u, double v) {
        return moving(static_cast<int>(scale * u), static_cast<int>(scale * v)) != 0;
      };
      // Of a pair, whose depth is of 80 x 60 px, the finger is too few tiles (moving_mask.h).
      if (!stereo) CHECK(at(camera.tip().x(), camera.tip().y()));
      CHECK_FALSE(at(140, 100));
      CHECK(loop.session.tracker_counts().lost == 0);
      expected_distance = loop.session.map()->distance(on_wall);
      REQUIRE(expected_distance);
      CHECK(std::abs(*expected_distance) <= test::tolerance(0.01, "a voxel"));
    }

    test::MisbehavingCamera camera(acts, shows);
    FrameLoop loop = loop_of(camera);
    VisionThread vision(camera, loop.camera, -1);
    std::size_t n = 0;
    while (!vision.ended()) {
      std::unique_ptr<FrameInFlight> flight = vision.next_within(0.001);
      if (!flight) continue;
      REQUIRE(n < expected.size());
      loop.session.respond(flight->scene);
      const Scene& scene = flight->scene;
      const Known now = known_of(scene);
      CHECK(now.number == expected[n].number);
      CHECK(now.state == expected[n].state);
      CHECK(now.world_from_camera.matrix() == expected[n].world_from_camera.matrix());
      CHECK(now.moving == expected[n].moving);
      vision.recycle(std::move(flight));
      ++n;
    }
    CHECK(n == expected.size());
    CHECK(loop.session.map()->distance(on_wall) == expected_distance);
    CHECK(vision.troubles().unreadable == 5 * 3 + SourceGuard::kClockRestart - 1);
    CHECK(vision.troubles().dropped == 3);
    CHECK(vision.troubles().stalls == 1);
    CHECK(vision.troubles().losses == 1);
  }
}

TEST_CASE("the loop can be left while a camera is silent", "[live][threads]") {
  test::MisbehavingCamera camera({test::Act::kStall});
  camera.repeats_last = true;
  FrameLoop loop = loop_for(camera);
  VisionThread vision(camera, loop.camera, -1);
  CHECK(vision.next_within(0.001) == nullptr);
  CHECK_FALSE(vision.ended());
}

TEST_CASE("a queue hands everything over in order and tells that it is closed", "[live][threads]") {
  BoundedQueue<int> queue(2);
  std::thread producer([&] {
    for (int i = 0; i < 1000; ++i) queue.push(i);
    queue.close();
  });
  int expected = 0;
  while (const auto item = queue.pop()) CHECK(*item == expected++);
  producer.join();
  CHECK(expected == 1000);
  CHECK_FALSE(queue.push(1));
  CHECK_FALSE(queue.pop().has_value());
}

TEST_CASE("a queue takes no memory once it is made", "[live]") {
  BoundedQueue<std::unique_ptr<int>> queue(3);
  std::unique_ptr<int> item = std::make_unique<int>(7);
  CHECK(test::allocations_during([&] {
          for (int i = 0; i < 1000; ++i) {
            queue.push(std::move(item));
            item = std::move(*queue.pop());
          }
        }) == 0);
  CHECK(*item == 7);
}

}  // namespace
}  // namespace palpable
