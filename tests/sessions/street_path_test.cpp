#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/slam/slam.h"
#include "palpable/live/sources/folder_source.h"
#include "tests/support/test.h"

#include <filesystem>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("a street is followed from the first pair on, also at four times the speed",
          "[track][real][long]") {
  const std::filesystem::path folder = "../shared/data/stereo_video_kitti1_long";
  if (!std::filesystem::exists(folder)) PALPABLE_SKIP("no folder " + folder.string());
  const std::vector<StampedPose> published = read_published_poses(folder).poses;
  for (const int every : {1, 2, 4}) {
    INFO("each " << every << ". pair");
    auto source = value_or_throw(open_folder(folder));
    DepthCamera camera = value_or_throw(DepthCamera::make(source->format()));
    Slam slam(camera);
    Frame frame;
    SeenFrame seen;
    StageTimes times;
    double path = 0, off = 0;
    const Rigid3 first = published.front().world_from_camera;
    Rigid3 last = first;
    for (int n = 0; source->next(frame) == FrameStatus::kFrame; ++n) {
      if (n % every != 0) continue;
      camera.see(frame, seen);
      const TrackedPose pose = slam.advance(seen, times).camera;
      INFO("pair " << n);
      CHECK(pose.state == (n == 0 ? TrackState::kFixed : TrackState::kTracking));
      CHECK((n == 0) == pose.world_from_camera.matrix().isIdentity(0));
      const Rigid3& truth = published.at(static_cast<std::size_t>(n)).world_from_camera;
      path += (truth.translation() - last.translation()).norm();
      last = truth;
      off = ((first.inverse() * truth).translation() - pose.world_from_camera.translation()).norm();
    }
    REQUIRE(path > 50);
    CHECK(off <= tolerance(0.012, "issue 30: 1.2 % of the way") * path);
  }
}

// Which pairs of a clip are played, in which order.
struct Played {
  int first = 0, last = 0;
  bool backwards = false;
};

// A street clip of which some pairs are played at 10 Hz. Frames that are lost, and the end of the
// path as a share of its length.
struct Driven {
  int lost = 0;
  double end_error = 0;
};

Driven drive_along(const std::vector<SeenFrame>& pairs, const std::vector<StampedPose>& published,
                   const DepthCamera& camera, const Played& played) {
  Slam slam(camera);
  StageTimes times;
  Driven driven;
  double path = 0, off = 0;
  const int count = played.last - played.first + 1;
  const auto pair_of = [&](int n) {
    return static_cast<std::size_t>(played.backwards ? played.last - n : played.first + n);
  };
  const Rigid3 first = published.at(pair_of(0)).world_from_camera;
  for (int n = 0; n < count; ++n) {
    SeenFrame seen = pairs.at(pair_of(n));
    seen.number = n;
    seen.time = 0.1 * n;
    const TrackedPose pose = slam.advance(seen, times).camera;
    driven.lost += pose.state == TrackState::kLost ? 1 : 0;
    const Rigid3& truth = published.at(pair_of(n)).world_from_camera;
    if (n > 0) {
      const Rigid3& before = published.at(pair_of(n - 1)).world_from_camera;
      path += (truth.translation() - before.translation()).norm();
    }
    off = ((first.inverse() * truth).translation() - pose.world_from_camera.translation()).norm();
  }
  driven.end_error = off / path;
  return driven;
}

TEST_CASE("a street that turns by 2.7 degrees a pair is followed from any pair on, and backwards",
          "[track][real][long]") {
  const std::filesystem::path folder = "../shared/data/stereo_video_turn";
  if (!std::filesystem::exists(folder)) PALPABLE_SKIP("no folder " + folder.string());
  const std::vector<StampedPose> published = read_published_poses(folder).poses;
  auto source = value_or_throw(open_folder(folder));
  DepthCamera camera = value_or_throw(DepthCamera::make(source->format()));
  std::vector<SeenFrame> pairs;
  Frame frame;
  while (source->next(frame) == FrameStatus::kFrame) camera.see(frame, pairs.emplace_back());
  REQUIRE(pairs.size() == 31);
  // The disparities of this clip are 1.2 px too small, which makes the way 6 % too long unless it
  // is noticed. From pair 2 on, repeated marks on the road agree with a wrong pose.
  for (const Played& played : {Played{0, 30}, Played{2, 30}, Played{7, 30}, Played{12, 30},
                               Played{0, 30, true}, Played{0, 24, true}, Played{0, 12, true}}) {
    INFO("pairs " << played.first << " to " << played.last << ", backwards " << played.backwards);
    const Driven driven = drive_along(pairs, published, camera, played);
    CHECK(driven.lost == 0);
    CHECK(driven.end_error <= tolerance(0.02, "issue 59: 2 % of the way"));
  }
}

}  // namespace
}  // namespace palpable
