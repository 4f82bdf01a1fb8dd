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

}  // namespace
}  // namespace palpable
