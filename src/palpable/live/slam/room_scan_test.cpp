#include "palpable/live/slam/room_scan.h"

#include "tests/support/noise_room.h"
#include "tests/support/seen_wall.h"
#include "tests/support/test.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

// A source whose frames are computed by a function.
class MadeSource final : public FrameSource {
 public:
  MadeSource(FrameFormat format, int count, std::function<Frame(int)> frame_at, bool live = false)
      : format_(std::move(format)), count_(count), frame_at_(std::move(frame_at)), live_(live) {}

  [[nodiscard]] const FrameFormat& format() const override { return format_; }
  FrameStatus next(Frame& frame) override {
    if (next_ == count_) return FrameStatus::kEnd;
    frame = frame_at_(next_++);
    return FrameStatus::kFrame;
  }
  [[nodiscard]] int frame_count() const override { return count_; }
  [[nodiscard]] std::string last_trouble() const override { return {}; }
  [[nodiscard]] bool is_live() const override { return live_; }

 private:
  FrameFormat format_;
  int count_;
  std::function<Frame(int)> frame_at_;
  bool live_;
  int next_ = 0;
};

OpenSource wall_of(int frames) {
  return [frames] {
    return std::make_unique<MadeSource>(test::wall_format(), frames,
                                        [](int n) { return test::frame_of_wall(n, 0); });
  };
}

bool always(const RoomScanStep&) { return true; }

// Error of a position, m, in the world frame of the first frame.
double off(const TrackedPose& frame, int n) {
  return (frame.world_from_camera.translation() - test::creeping_pose(n).translation()).norm();
}

TEST_CASE("a recording in which a loop is closed is played once more along the corrected way",
          "[slam][room_scan][long]") {
  for (const bool live : {false, true}) {
    INFO("a camera, which cannot be played again: " << live);
    int opened = 0, steps_again = 0;
    const RoomScan scanned = scan_room(
        [&] {
          ++opened;
          return std::make_unique<MadeSource>(test::creeping_format(), test::kCreepingFrames,
                                              test::creeping_frame, live);
        },
        {},
        [&](const RoomScanStep& step) {
          steps_again += step.again ? 1 : 0;
          return !step.again;  // false does not end the second pass
        });
    CHECK(scanned.loops >= 1);
    CHECK(scanned.again != live);
    CHECK(opened == (live ? 1 : 2));
    CHECK(steps_again == (live ? 0 : test::kCreepingFrames));
    REQUIRE(scanned.frames.size() == test::kCreepingFrames);
    CHECK(scanned.keyframes.size() > 20);
    const ColoredSurface mesh = scanned.slam->map()->mesh();
    REQUIRE(mesh.surface.vertex_count() > 0);
    // The wall behind the first camera, 2.2 m away, was in view half way round.
    const double back = mesh.surface.vertices.row(2).minCoeff();
    if (live) {  // the map from before the loop was cleared
      CHECK(off(scanned.frames[test::kCreepingCircle], test::kCreepingCircle) > 0.1);
      CHECK(back > -1);
      continue;
    }
    for (int n = test::kCreepingCircle; n < test::kCreepingFrames; ++n) {
      INFO("frame " << n);
      // Successive frames are 29 mm apart, so an index error would be noticed.
      CHECK(off(scanned.frames[n], n) <
            tolerance(0.025, "12 px of 2.3 mm by the loop (20 mm as measured), nothing beyond"));
    }
    CHECK(back < -2);
  }
}

TEST_CASE("a frame's corrected pose follows from its keyframe's final pose, or is unknown",
          "[slam][room_scan]") {
  const auto moved = [](double x, double angle) {
    return Rigid3(Eigen::Translation3d(x, 0, 0) *
                  Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  };
  const std::vector<KeyframePose> keyframes{{3, 0.1, moved(1, 0.5)}, {8, 0.3, moved(2, -0.3)}};
  const auto seen_after = [&](int keyframe, TrackState state) {
    return TrackedPose{.world_from_camera = moved(9, 1),
                       .state = state,
                       .newest_keyframe = keyframe,
                       .keyframe_from_camera = moved(0.25, 0.2)};
  };
  const std::vector<TrackedPose> frames{
      seen_after(3, TrackState::kTracking), seen_after(8, TrackState::kFixed),
      seen_after(8, TrackState::kLost), seen_after(5, TrackState::kTracking)};
  const auto way = corrected_path(frames, keyframes);
  REQUIRE(way.size() == 4);
  REQUIRE((way[0] && way[1]));
  CHECK(way[0]->isApprox(moved(1, 0.5) * moved(0.25, 0.2)));
  CHECK(way[1]->isApprox(moved(2, -0.3) * moved(0.25, 0.2)));
  CHECK_FALSE(way[2]);  // it was lost
  CHECK_FALSE(way[3]);  // its keyframe was removed
}

TEST_CASE("without a loop a recording is played once, as far as is asked for",
          "[slam][room_scan]") {
  int opened = 0;
  const OpenSource open = [&] {
    ++opened;
    return wall_of(12)();
  };
  CHECK(scan_room(open, {}, always).frames.size() == 12);
  CHECK(opened == 1);
  CHECK(scan_room(open, {.most_frames = 7}, always).frames.size() == 7);
  CHECK(scan_room(open, {.most_frames = 99}, always).frames.size() == 12);
  int most = 0;
  const RoomScan ended = scan_room(open, {}, [&](const RoomScanStep& step) {
    CHECK(step.total == 12);
    CHECK_FALSE(step.again);
    most = step.read;
    return step.read < 5;
  });
  CHECK(ended.frames.size() == 5);
  CHECK(most == 5);
  CHECK(scan_room(wall_of(0), {}, always).frames.empty());
}

TEST_CASE("poses that are given are taken by the source's time, and nothing is followed",
          "[slam][room_scan]") {
  RoomScanSettings settings;
  settings.slam.fuse_every = 0;
  settings.pose_at = [](double time) -> std::optional<Rigid3> {
    if (time > 9.5 / 30) return std::nullopt;
    return Rigid3(Eigen::Translation3d(1, 0, 30 * time / 100));
  };
  const RoomScan scanned = scan_room(wall_of(12), settings, always);
  REQUIRE(scanned.frames.size() == 12);
  CHECK(scanned.frames[9].world_from_camera.translation().isApprox(Eigen::Vector3d(1, 0, 0.09)));
  CHECK(scanned.slam->counts().fused == 10);
  CHECK(scanned.slam->counts().lost == 2);
  CHECK(scanned.slam->tracker() == nullptr);
  CHECK(scanned.keyframes.empty());
}

TEST_CASE("the surface of one pair has all voxels, that of many frames those on which they agree",
          "[slam][room_scan]") {
  for (const int frames : {1, 12}) {
    INFO(frames << " frames");
    RoomScanSettings settings;
    settings.slam.fuse_every = 0;
    settings.most_frames = frames;
    const RoomScan scanned = scan_room(
        [&] {
          return std::make_unique<MadeSource>(test::creeping_format(), test::kCreepingFrames,
                                              test::creeping_frame);
        },
        settings, [](const RoomScanStep&) { return true; });
    const SurfaceMap& map = *scanned.slam->map();
    const Eigen::Index found = surface_of(scanned).surface.triangle_count();
    CHECK(found == (frames == 1 ? map.mesh(0) : map.mesh()).surface.triangle_count());
    CHECK(found > 1000);
    // For a single noise-free frame the two meshes are the same; tests/cli compares them for a
    // noisy pair.
    if (frames > 1) {
      CHECK(map.mesh().surface.triangle_count() < map.mesh(0).surface.triangle_count());
    }
  }
}

TEST_CASE("a farther scan takes less accurate depths, and tracking keeps its range",
          "[slam][room_scan]") {
  const RoomScanSettings usual;
  RoomScanSettings far = usual;
  set_farthest(2 * usual.slam.surface.farthest, far);
  CHECK(far.slam.surface.farthest == 2 * usual.slam.surface.farthest);
  CHECK(far.slam.surface.best_sigma == 4 * usual.slam.surface.best_sigma);
  CHECK(far.slam.surface.largest_sigma == 2 * usual.slam.surface.largest_sigma);
  CHECK_FALSE(far.depth.farthest);
  RoomScanSettings near = usual;
  set_farthest(0.5, near);
  CHECK(near.slam.surface.farthest == 0.5);
  CHECK(near.slam.surface.best_sigma == usual.slam.surface.best_sigma);
  CHECK_FALSE(near.depth.farthest);
  RoomScanSettings street = usual;
  set_farthest(40, street);
  CHECK(street.depth.farthest == 40);
}

TEST_CASE("the summary of a scan lists frames, troubles and loops", "[slam][room_scan]") {
  RoomScanSettings settings;
  settings.slam.fuse_every = 0;
  settings.pose_at = [](double time) -> std::optional<Rigid3> {
    if (time > 2.5 / 30) return std::nullopt;
    return Rigid3::Identity();
  };
  RoomScan scanned = scan_room(wall_of(4), settings, always);
  const std::string depth = text_of(scanned.depth);  // a line, of its own test
  CHECK(text_of(scanned) == "4 frames, 3 fused, 1 without a pose\n" + depth);
  scanned.troubles.unreadable = 2;
  scanned.last_trouble = "cut off";
  scanned.new_worlds = 1;
  scanned.loops = 1;
  CHECK(text_of(scanned) ==
        "4 frames, 3 fused, 1 without a pose\n" + depth +
            "2 unreadable, the last: cut off\n"
            "1 new world began: the surface holds what was seen since the last\n"
            "1 loop closed: the surface holds what was seen since the last\n");
  scanned.loops = 2;
  scanned.again = true;
  CHECK_THAT(text_of(scanned), Catch::Matchers::EndsWith(
                                   "2 loops closed: fused once more along the corrected way\n"));
}

}  // namespace
}  // namespace palpable
