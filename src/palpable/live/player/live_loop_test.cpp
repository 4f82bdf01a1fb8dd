#include "palpable/live/player/live_loop.h"

#include "palpable/common/base/error.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/test.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::Act;

// A run with a sphere of radius 5 cm and centre (0, 0, 0.4) m, its top towards the camera's -Y.
LiveRun run_of(const std::vector<Act>& acts) {
  auto camera = std::make_unique<test::MisbehavingCamera>(acts);
  Rigid3 pose = Rigid3::Identity();
  pose.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  pose.translation() = Eigen::Vector3d(0, 0.05, 0.4);
  FrameLoop loop = std::move(FrameLoop::make(test::DentedSphere{}.body(), pose, camera->format(),
                                             {.press_static = true, .map = false})
                                 .value());
  return {std::move(camera), std::move(loop), "a camera"};
}

TEST_CASE("a run's loop answers every frame, and counts what happened", "[player][threads]") {
  std::vector<Act> acts(14, Act::kGood);
  acts.insert(acts.end(), 3, Act::kGarbage);
  acts.insert(acts.end(), 10, Act::kGood);
  LiveRun run = run_of(acts);
  std::vector<std::string> reports;
  LiveLoop loop(run, -1, [&](const std::string& line) { reports.push_back(line); });
  std::vector<int> numbers, touching;
  double deepest = 0;
  while (const Scene* scene = loop.next()) {
    numbers.push_back(scene->number);
    CHECK(scene->times.ms("read") > 0);
    CHECK(scene->times.ms("contact") > 0);
    if (scene->touches.empty()) continue;
    touching.push_back(scene->number);
    deepest = std::max(deepest, scene->touches.front().press_depth);
  }
  CHECK(loop.ended());
  CHECK(loop.next() == nullptr);
  CHECK(loop.total() <= 0);  // this camera does not state a number
  const LiveCounts& counts = loop.counts();
  CHECK(numbers.size() == 24);
  CHECK(counts.processed == numbers);
  REQUIRE_FALSE(touching.empty());
  CHECK(touching.size() < numbers.size());
  CHECK(counts.touching == static_cast<int>(touching.size()));
  CHECK(counts.first_touch == touching.front());
  CHECK(counts.deepest == deepest);
  CHECK(counts.troubles.unreadable == 3);
  CHECK(counts.last_trouble == "the picture is cut off");
  CHECK(counts.reports.size() == 1);  // of three unreadable frames in a row
  CHECK(reports == counts.reports);
}

// A depth camera that measures nothing, as a covered lens.
class BlindCamera final : public FrameSource {
 public:
  explicit BlindCamera(int frames) : camera_(std::vector<Act>(frames, Act::kGood)) {}
  const FrameFormat& format() const override { return camera_.format(); }
  FrameStatus next(Frame& frame) override {
    const FrameStatus status = camera_.next(frame);
    std::fill(frame.depth.begin(), frame.depth.end(), std::numeric_limits<float>::quiet_NaN());
    return status;
  }
  int frame_count() const override { return camera_.frame_count(); }
  std::string last_trouble() const override { return camera_.last_trouble(); }

 private:
  test::MisbehavingCamera camera_;
};

TEST_CASE("a run without depth says so once: after 30 frames, or a shorter one when it ends",
          "[player][threads][depth]") {
  for (const int frames : {3, 40}) {
    CAPTURE(frames);
    LiveRun run = run_of({});
    run.source = std::make_unique<BlindCamera>(frames);
    std::vector<std::string> reports;
    LiveLoop loop(run, -1, [&](const std::string& line) { reports.push_back(line); });
    int answered = 0;
    while (loop.next() != nullptr) {
      ++answered;
      CHECK(reports.size() == (answered < 30 ? 0U : 1U));
    }
    REQUIRE(answered == frames);
    loop.finish();
    loop.finish();
    REQUIRE(reports.size() == 1);
    CHECK_THAT(reports[0], Catch::Matchers::Contains(
                               "warning: a camera: depth was measured in 0 % of the pixels"));
    CHECK(loop.counts().reports == reports);
  }
}

TEST_CASE("a run's loop ends after the frames that were asked for", "[player][threads]") {
  LiveRun run = run_of(std::vector<Act>(9, Act::kGood));
  LiveLoop loop(run, 4);
  CHECK(loop.total() == 4);
  int frames = 0;
  while (loop.next() != nullptr) ++frames;
  CHECK(frames == 4);
  CHECK(loop.ended());
}

TEST_CASE("a loop that begins anew goes on with the source's next frame, and keeps its counts",
          "[player][threads]") {
  std::vector<Act> acts(20, Act::kGood);
  acts[2] = Act::kGarbage;
  LiveRun run = run_of(acts);
  LiveLoop loop(run, 15);
  for (int k = 0; k < 5; ++k) REQUIRE(loop.next() != nullptr);
  int changes = 0;
  loop.begin_anew([&](LiveRun& changed) {
    CHECK(&changed == &run);
    ++changes;
  });
  CHECK_THROWS_AS(loop.begin_anew([](LiveRun&) { throw Error("it cannot be changed"); }), Error);
  CHECK(changes == 1);
  int last = -1;
  while (const Scene* scene = loop.next()) {
    CHECK(scene->number > last);
    last = scene->number;
  }
  const LiveCounts& counts = loop.counts();
  // At each restart at most three frames that were read ahead are dropped; the limit
  // is fifteen frames.
  CHECK(counts.processed.size() >= 19 - 6 - 1);
  CHECK(counts.processed.size() <= 15);
  CHECK(counts.troubles.unreadable == 1);
  CHECK(counts.last_trouble == "the picture is cut off");
}

TEST_CASE("a scene that is swapped out of the loop stays, and what is given instead is used",
          "[player][threads]") {
  LiveRun run = run_of(std::vector<Act>(30, Act::kGood));
  LiveLoop loop(run);
  Scene kept;
  std::set<const float*> memory;  // addresses of all depth images that the loop has used
  int number = -1;
  while (Scene* scene = loop.next()) {
    const Eigen::Matrix3Xf vertices = scene->bodies[0].vertices;
    std::swap(kept, *scene);
    number = kept.number;
    CHECK(kept.bodies[0].vertices == vertices);
    memory.insert(kept.seen.depth.data());
  }
  CHECK(number == 29);
  CHECK(memory.size() <= 4);  // three that circulate and one that was kept
}

TEST_CASE("a loop that waits in vain for a silent camera returns, and has not ended",
          "[player][threads]") {
  LiveRun run = run_of({Act::kGood, Act::kStall});
  static_cast<test::MisbehavingCamera&>(*run.source).repeats_last = true;
  LiveLoop loop(run);
  REQUIRE(loop.next() != nullptr);
  CHECK(loop.next_within(0.001) == nullptr);
  CHECK_FALSE(loop.ended());
}

TEST_CASE("touches at another site than the one before are counted, also after a pause",
          "[player]") {
  LiveCounts counts;
  Scene scene;
  for (const int site : {-1, 2, 2, -1, 1, 1, 2}) {
    scene.touches.clear();
    if (site >= 0) scene.touches.push_back({.site = site, .press_depth = 0.001 * site});
    counts.add(scene);
    ++scene.number;
  }
  CHECK(counts.processed.size() == 7);
  CHECK(counts.touching == 5);
  CHECK(counts.first_touch == 1);
  CHECK(counts.site_changes == 2);
  CHECK(counts.deepest == 0.002);
  CHECK(counts.lost.empty());
  scene.camera.state = TrackState::kLost;
  counts.add(scene);
  CHECK(counts.lost == std::vector<int>{7});
  CHECK(counts.new_worlds.empty());
  scene.camera.state = TrackState::kFixed;
  scene.camera.new_world = true;
  counts.add(scene);
  CHECK(counts.new_worlds == std::vector<int>{7});
}

}  // namespace
}  // namespace palpable
