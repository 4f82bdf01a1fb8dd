#include "palpable/live/player/vision_thread.h"
#include "palpable/live/session/frame_loop.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/test.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {
namespace {

// The results of one frame that are compared between a loop with a vision thread and one without.
struct Known {
  int number = 0;
  TrackState state = TrackState::kStarting;
  Rigid3 world_from_camera;
  MaskImage moving;
};

Known known_of(const Scene& scene) {
  return {scene.number, scene.camera.state, scene.camera.world_from_camera, scene.moving};
}

// Plays all malfunctions of a camera without a vision thread and with one.
void follow_through_troubles(test::Shows shows) {
  using test::Act;
  const bool stereo = shows == test::Shows::kStereoRoom;
  std::vector<Act> acts(test::MisbehavingCamera::kAlone, Act::kGood);
  for (const Act bad : {Act::kStall, Act::kDrop, Act::kResize, Act::kGarbage, Act::kNoTime,
                        stereo ? Act::kRightResize : Act::kNoDepth, Act::kBackInTime, Act::kGone}) {
    acts.insert(acts.end(), 3, bad);
    acts.insert(acts.end(), 3, Act::kGood);
  }
  acts.push_back(Act::kNewClock);
  acts.insert(acts.end(), 9, Act::kGood);

  const auto loop_of = [](const FrameSource& source) {
    Rigid3 far_aside = Rigid3::Identity();  // the body is not tested here
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
    // At the end the finger moves, and the pixels far from it are not in the mask.
    const MaskImage& moving = expected.back().moving;
    const double scale = static_cast<double>(moving.width()) / camera.format().width;
    const auto at = [&](double u, double v) {
      return moving(static_cast<int>(scale * u), static_cast<int>(scale * v)) != 0;
    };
    // In a pair with depth of 80 x 60 px the finger covers too few tiles (moving_mask.h).
    if (!stereo) CHECK(at(camera.tip().x(), camera.tip().y()));
    CHECK_FALSE(at(140, 100));
    CHECK(loop.session.slam().tracker()->counts().lost == 0);
    expected_distance = loop.session.slam().map()->distance(on_wall);
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
  CHECK(loop.session.slam().map()->distance(on_wall) == expected_distance);
  const SourceTroubles troubles = vision.take_reports().troubles;
  CHECK(troubles.unreadable == 5 * 3 + SourceGuard::kClockRestart - 1);
  CHECK(troubles.dropped == 3);
  CHECK(troubles.stalls == 1);
  CHECK(troubles.losses == 1);
}

TEST_CASE("through all that a depth camera does wrong it is followed, and the map stays",
          "[player][threads][errors]") {
  follow_through_troubles(test::Shows::kRoom);
}

TEST_CASE("through all that a stereo camera does wrong it is followed, and the map stays",
          "[player][threads][errors]") {
  follow_through_troubles(test::Shows::kStereoRoom);
}

}  // namespace
}  // namespace palpable
