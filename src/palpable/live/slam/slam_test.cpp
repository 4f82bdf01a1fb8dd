#include "palpable/live/slam/slam.h"

#include "tests/support/noise_room.h"
#include "tests/support/seen_wall.h"
#include "tests/support/test.h"

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

using test::frame_of_wall;

// A camera that stands still in front of a wall; an object may cover a share of the picture.
struct Room {
  explicit Room(const SlamSettings& settings = {})
      : camera(std::move(DepthCamera::make(test::wall_format()).value())), slam(camera, settings) {}

  // Adds an object at a depth of `Z` m that covers the share `covers` of the picture, from its
  // left.
  const SeenFrame& see(Frame frame, double covers = 0, float Z = 0.4F) {
    const auto columns = static_cast<int>(covers * frame.depth.width());
    for (int y = 0; y < frame.depth.height(); ++y) {
      std::fill_n(frame.depth.row(y), columns, Z);
      std::fill_n(frame.left.row(y), columns, Rgb{200, 150, 120});
    }
    camera.see(frame, seen);
    return seen;
  }
  const SlamFrame& show(double covers = 0) {
    return slam.advance(see(frame_of_wall(number++, 0), covers), times);
  }
  const SlamFrame& show_dark(double z = 0) {
    Frame frame = frame_of_wall(number++, 0, z);
    std::fill(frame.left.begin(), frame.left.end(), Rgb{});
    return slam.advance(see(frame), times);
  }

  DepthCamera camera;
  Slam slam;
  SeenFrame seen;
  StageTimes times;
  int number = 0;
};

double share_of(const MaskImage& mask) {
  const auto set = std::count_if(mask.begin(), mask.end(), [](auto m) { return m != 0; });
  return static_cast<double>(set) / static_cast<double>(mask.size());
}

// Covered by half: 80 of 161 columns, whole tiles of 4 px.
constexpr double kHalf = 80.0 / 161;

const Eigen::Vector3d kOnWall{0, 0, test::kWallZ};

TEST_CASE("depths go into the map at the rate that is asked for, by the source's time", "[slam]") {
  const auto fused = [](double every, int step) {
    Room room({.track = false, .fuse_every = every});
    for (int n = 0; n < 30; n += step) {
      room.slam.advance(room.see(frame_of_wall(n, 0)), room.times);
    }
    return room.slam.counts().fused;
  };
  CHECK(fused(0.1, 1) == 10);
  CHECK(fused(0.1, 5) == 6);  // at 6 frames per second all of them are fused
  CHECK(fused(0, 1) == 30);
}

TEST_CASE("what comes into the room moves and stays out of its map", "[slam]") {
  Room room({.track = false});
  for (int n = 0; n < 30; ++n) CHECK(share_of(*room.show().moving) == 0);
  REQUIRE(room.slam.map()->distance(kOnWall).has_value());
  for (int n = 0; n < 30; ++n) {
    const SlamFrame& found = room.show(0.5);
    REQUIRE(found.moving != nullptr);
    CHECK(share_of(*found.moving) == Approx(kHalf));
    CHECK(found.camera.state == TrackState::kFixed);
    CHECK(found.camera.world_from_camera.matrix().isIdentity(0));
  }
  // A point of the object, half way to the left of the middle.
  CHECK_FALSE(room.slam.map()->distance({-0.06, 0, 0.4}).has_value());
  CHECK(room.slam.space()->is_free({-0.06, 0, 0.4}));
}

TEST_CASE("depth that is none of the pixel's own stays out of the map", "[slam]") {
  Room room({.track = false});
  for (int n = 0; n < 80; ++n) {
    const SlamFrame& found = room.show();
    REQUIRE(found.borrowed != nullptr);
    CHECK(share_of(*found.borrowed) == 0);
  }
  for (int n = 0; n < 30; ++n) {
    // The depth is wrong, but the picture still shows the wall.
    Frame frame = frame_of_wall(room.number++, 0);
    for (int y = 0; y < frame.depth.height(); ++y) std::fill_n(frame.depth.row(y), 80, 0.4F);
    room.camera.see(frame, room.seen);
    const SlamFrame& found = room.slam.advance(room.seen, room.times);
    CHECK(share_of(*found.moving) < 0.01);  // at the border between both depths
    CHECK(share_of(*found.borrowed) > 0.4);
  }
  CHECK_FALSE(room.slam.map()->distance({-0.06, 0, 0.4}).has_value());
}

TEST_CASE("a mask of more than 70 % of the picture is used only if the camera stands still",
          "[slam]") {
  for (const bool stands : {false, true}) {
    INFO("stands " << stands);
    Room room({.track = false, .fuse_every = 0});
    const auto show = [&](double covers) {
      const SeenFrame& seen = room.see(frame_of_wall(room.number++, 0), covers);
      return stands ? room.slam.advance(seen, room.times)
                    : room.slam.advance(seen, Rigid3::Identity(), room.times);
    };
    for (int n = 0; n < 30; ++n) show(0);
    for (int n = 0; n < 9; ++n) CHECK((show(0.8).moving != nullptr) == stands);
    CHECK(room.slam.counts().fused == (stands ? 39 : 30));
    CHECK(room.slam.counts().masks == 39);
    CHECK(show(0.6).moving != nullptr);
    CHECK(room.slam.counts().fused == (stands ? 40 : 31));
  }
}

TEST_CASE("a wall stands still in a map of coarse voxels too, wherever it lies in them", "[slam]") {
  for (const double z : {0.0, 0.01, 0.02, 0.03, 0.04}) {
    INFO("the camera at " << z << " m");
    Room room({.track = false, .fuse_every = 0, .surface = {.voxel = 0.05, .truncation = 0.2}});
    const Rigid3 aside(Eigen::Translation3d(0, 0, z));
    for (int n = 0; n < 40; ++n) {
      const SlamFrame& found = room.slam.advance(room.see(frame_of_wall(n, 0)), aside, room.times);
      REQUIRE(found.moving != nullptr);
      CHECK(share_of(*found.moving) == 0);
    }
  }
}

TEST_CASE("given poses are used, and a frame without a pose changes nothing", "[slam]") {
  Room room({.track = false, .fuse_every = 0});
  Rigid3 aside = Rigid3::Identity();
  aside.translation().x() = 1;
  for (int n = 0; n < 10; ++n) {
    const SlamFrame& found = room.slam.advance(room.see(frame_of_wall(n, 0)), aside, room.times);
    CHECK(found.camera.state == TrackState::kTracking);
    CHECK(found.camera.world_from_camera.matrix() == aside.matrix());
    CHECK(found.fused);
  }
  CHECK(room.slam.map()->distance(aside * kOnWall).has_value());
  CHECK_FALSE(room.slam.map()->distance(kOnWall).has_value());

  const SlamFrame& lost =
      room.slam.advance(room.see(frame_of_wall(10, 0)), std::nullopt, room.times);
  CHECK(lost.camera.state == TrackState::kLost);
  CHECK(lost.camera.world_from_camera.matrix() == aside.matrix());
  CHECK(lost.moving == nullptr);
  CHECK_FALSE(lost.fused);
  CHECK(room.slam.counts().lost == 1);
  CHECK(room.slam.counts().fused == 10);
}

TEST_CASE("before a bare wall there is nothing to follow, and what comes is seen to move",
          "[slam]") {
  Room room;
  const auto show_bare = [&](double covers) {
    Frame frame = frame_of_wall(room.number++, 0);
    std::fill(frame.left.begin(), frame.left.end(), Rgb{120, 120, 120});
    return room.slam.advance(room.see(frame, covers), room.times);
  };
  for (int n = 0; n < 30; ++n) {
    const SlamFrame found = show_bare(0);
    CHECK(found.camera.state == TrackState::kStarting);
    REQUIRE(found.moving != nullptr);
    CHECK(share_of(*found.moving) == 0);
  }
  const SlamFrame found = show_bare(0.5);
  REQUIRE(found.moving != nullptr);
  CHECK(share_of(*found.moving) == Approx(kHalf));
}

TEST_CASE("what a camera saw before it moved in the dark is forgotten when it can be followed",
          "[slam]") {
  Room room({.fuse_every = 0});
  for (int n = 0; n < 10; ++n) CHECK(room.show_dark().fused);
  const int blocks = room.slam.map()->blocks();
  CHECK(blocks > 0);
  // The camera moves. If it were assumed to stand still, the wall's depths would lie in free space.
  for (int n = 0; n < 10; ++n) {
    const SlamFrame& found = room.show_dark(0.1 + 0.01 * n);
    CHECK(found.camera.state == TrackState::kLost);
    CHECK(found.moving == nullptr);
    CHECK_FALSE(found.fused);
  }
  CHECK(room.slam.counts().lost == 10);
  CHECK(room.slam.map()->blocks() == blocks);
  bool began = false;
  for (int n = 0; n < 6 && !began; ++n) {
    Frame frame = frame_of_wall(room.number++, 0, 0.2);
    began = room.slam.advance(room.see(frame), room.times).camera.new_world;
  }
  REQUIRE(began);
  CHECK(room.slam.map()->blocks() == 0);
  CHECK(room.slam.space()->blocks() == 0);
}

TEST_CASE("a lost camera learns nothing and finds what moves again in the second frame after",
          "[slam]") {
  Room room({.fuse_every = 0});
  for (const double x : {0.0, 0.0, 0.01, 0.02, 0.03, 0.02, 0.01, 0.0}) {
    const SlamFrame& found =
        room.slam.advance(room.see(frame_of_wall(room.number++, x)), room.times);
    REQUIRE(found.moving != nullptr);
    CHECK(found.fused);
  }
  const int fused = room.slam.counts().fused;
  for (int n = 0; n < 5; ++n) {
    const SlamFrame& found = room.show_dark();
    REQUIRE(found.camera.state == TrackState::kLost);
    CHECK(found.moving == nullptr);
    CHECK_FALSE(found.fused);
  }
  CHECK(room.slam.counts().fused == fused);
  CHECK(room.slam.counts().lost == 5);
  CHECK(room.slam.tracker()->counts().lost == 5);

  const SlamFrame& again = room.show();
  REQUIRE(is_known(again.camera));
  CHECK(again.moving == nullptr);
  CHECK(room.slam.counts().fused == fused);
  CHECK(room.show().moving != nullptr);
  CHECK(room.slam.counts().fused == fused + 1);
}

TEST_CASE("a camera that walks to a wall and leaves out frames sees nothing move", "[slam]") {
  Room room;
  // The camera accelerates to 0.5 m/s within a second. After two missing frames, a prediction by
  // one frame's motion would be 33 mm too short, twice the tolerance of the mask.
  const auto z_at = [](int n) {
    const double t = n / 30.0;
    return t < 1 ? 0.25 * t * t : 0.5 * t - 0.25;
  };
  int gap = 3;
  for (int n = 0; n < 37; n += gap = 4 - gap) {
    INFO("frame " << n);
    const SlamFrame& found = room.slam.advance(room.see(frame_of_wall(n, 0, z_at(n))), room.times);
    REQUIRE(is_known(found.camera));
    CHECK(found.camera.world_from_camera.translation().z() ==
          Approx(z_at(n)).margin(test::tolerance(
              6e-3, "up to 0.3 px it stands: 5 mm for what lies 45 px from the middle")));
    REQUIRE(found.moving != nullptr);
    CHECK(share_of(*found.moving) == 0);
  }
  CHECK(room.slam.counts().frames == 19);
}

TEST_CASE("after an unpredictable motion the mask is computed with the pose that was found",
          "[slam]") {
  Room room({.fuse_every = 0});
  for (int n = 0; n < 30; ++n) room.show();
  // With the predicted pose, the wall would be 80 mm in front of its position in the map.
  const SlamFrame& found =
      room.slam.advance(room.see(frame_of_wall(room.number++, 0, 0.08)), room.times);
  REQUIRE(found.camera.state == TrackState::kTracking);
  CHECK(found.camera.prediction_error_px > 4);
  REQUIRE(found.moving != nullptr);
  CHECK(share_of(*found.moving) == 0);
}

TEST_CASE("when a loop is closed the map is cleared and the corrections are returned",
          "[slam][long]") {
  DepthCamera camera = std::move(DepthCamera::make(test::creeping_format()).value());
  SlamSettings settings;
  settings.fuse_every = 2;  // the first frame after the loop would not be due yet
  Slam slam(camera, settings);
  SeenFrame seen;
  StageTimes times;
  int closed = 0;
  bool began_anew = false;  // in the frame before
  for (int n = 0; n < test::kCreepingFrames; ++n) {
    INFO("frame " << n);
    camera.see(test::creeping_frame(n), seen);
    const int blocks = slam.map()->blocks(), free = slam.space()->blocks();
    const SlamFrame& found = slam.advance(seen, times);
    REQUIRE(is_known(found.camera));
    CHECK(found.corrections.empty() != found.camera.closed_loop);
    if (began_anew) CHECK(found.fused);  // independent of when the cleared map was last fused
    began_anew = found.camera.closed_loop;
    if (!found.camera.closed_loop) continue;
    ++closed;
    CHECK(found.moving == nullptr);
    CHECK_FALSE(found.fused);
    CHECK((blocks > 1000 && free > 200));  // about half of the measured 1812 and 390
    CHECK(slam.map()->blocks() == 0);
    CHECK(slam.space()->blocks() == 0);
  }
  CHECK(closed >= 1);
  CHECK(slam.map()->blocks() > 360);  // half of the 720 that one view of a wall gives
}

TEST_CASE("without a map the camera alone is followed", "[slam]") {
  Room room({.map = false});
  for (int n = 0; n < 3; ++n) {
    const SlamFrame& found = room.show();
    CHECK(is_known(found.camera));
    CHECK(found.moving == nullptr);
    CHECK_FALSE(found.fused);
  }
  CHECK(room.slam.map() == nullptr);
  CHECK(room.slam.space() == nullptr);
  CHECK(room.slam.tracker()->counts().frames == 3);
}

}  // namespace
}  // namespace palpable
