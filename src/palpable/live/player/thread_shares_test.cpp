#include "palpable/live/player/thread_shares.h"

#include "palpable/live/player/live_loop.h"
#include "palpable/live/player/live_run.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("whatever the budget, each part has a thread and none has more than the budget",
          "[player][threads]") {
  for (int threads = 1; threads <= 64; ++threads) {
    INFO(threads);
    const ThreadShares shares = thread_shares(threads);
    CHECK((shares.matching >= 1 && shares.matching <= std::min(threads, 16)));
    CHECK((shares.images >= 1 && shares.images <= threads));
    CHECK((shares.drawing >= 0 && shares.drawing < threads));
  }
  CHECK(usual_threads() >= 1);
  CHECK_THROWS_AS(thread_shares(0), ContractViolation);
}

// All results of a frame.
struct FrameResult {
  int number = 0;
  ColorImage color;
  DepthImage depth;
  MaskImage moving;
  Eigen::Matrix4d world_from_camera;
  Eigen::Matrix3Xf vertices;
};

bool same_bytes(const FrameResult& a, const FrameResult& b) {
  // Compares bytes, because NaN must equal NaN.
  const bool depth =
      a.depth.size() == b.depth.size() &&
      std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0;
  return depth && a.number == b.number && a.color == b.color && a.moving == b.moving &&
         a.world_from_camera == b.world_from_camera && a.vertices == b.vertices;
}

std::vector<FrameResult> answers_with(int threads) {
  auto camera = std::make_unique<test::MisbehavingCamera>(
      std::vector<test::Act>(24, test::Act::kGood), test::Shows::kStereoRoom);
  Rigid3 place = Rigid3::Identity();
  place.translation() = Eigen::Vector3d(0, 0.05, 0.4);
  LiveSettings wanted;
  wanted.images.device = "nowhere/a camera";
  wanted.place = place;
  wanted.threads = threads;
  std::vector<LiveBody> bodies;
  bodies.push_back({test::DentedSphere{}.body()});
  LiveRun run = open_live(std::move(bodies), wanted, std::move(camera));
  CHECK(run.loop.session.settings().depth.threads == thread_shares(threads).matching);
  LiveLoop loop(run);
  std::vector<FrameResult> answers;
  while (const Scene* scene = loop.next()) {
    answers.push_back({scene->number, scene->seen.color, scene->seen.depth, scene->moving,
                       scene->camera.world_from_camera.matrix(), scene->bodies[0].vertices});
  }
  return answers;
}

TEST_CASE("a run gives the same bytes with a budget of 1, 2 and 8 threads", "[player][threads]") {
  const std::vector<FrameResult> alone = answers_with(1);
  REQUIRE(alone.size() >= 20);
  for (const int threads : {2, 8}) {
    INFO(threads);
    const std::vector<FrameResult> together = answers_with(threads);
    REQUIRE(together.size() == alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      INFO("frame " << alone[i].number);
      CHECK(same_bytes(together[i], alone[i]));
    }
  }
}

}  // namespace
}  // namespace palpable
