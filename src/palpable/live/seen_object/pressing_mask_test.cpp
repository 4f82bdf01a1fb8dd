#include "palpable/live/seen_object/pressing_mask.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <random>

namespace palpable {
namespace {

const PinholeCamera kCamera{160, 96, 150, 150, 80.2, 47.1};
const DepthNoise kNoise{0, 0, 0.006};
constexpr float kWall = 1.0f;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
const PixelBox kAll{0, 0, kCamera.width, kCamera.height};

// A wall and a thing before it, seen by a standing camera.
struct Room {
  Room() { scene.emplace(map); }

  // Adds frames in which nothing moves, so that the thing becomes part of the map.
  void show(int frames) {
    for (int i = 0; i < frames; ++i) {
      space.add(kCamera.scaled_down(8), Rigid3::Identity(), depth_of(kCamera.scaled_down(8)));
      if (frame++ % 3 != 0) continue;
      map.fuse(depth_of(kCamera), kCamera, Rigid3::Identity());
      scene->update(map, space);
    }
  }
  DepthImage depth_of(const PinholeCamera& camera) {
    std::normal_distribution<double> normal;
    DepthImage depth(camera.width, camera.height);
    const double scale = static_cast<double>(kCamera.width) / camera.width;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        float z = kWall;
        if (things.contains(static_cast<int>(scale * x), static_cast<int>(scale * y))) z = thing_z;
        depth(x, y) =
            z + static_cast<float>(0.3 * kNoise.sigma(static_cast<double>(z)) * normal(random));
      }
    }
    return depth;
  }
  SeenFrame seen() {
    SeenFrame result;
    result.depth = depth_of(kCamera);
    result.depth_camera = kCamera;
    return result;
  }
  // Adds four frames in which the thing moves.
  void come() {
    MaskImage moving(kCamera.width, kCamera.height, 0);
    for (int y = things.y; y < things.y + things.height; ++y) {
      for (int x = things.x; x < things.x + things.width; ++x) moving(x, y) = 255;
    }
    for (int i = 0; i < 4; ++i) {
      show(1);
      (void)find(seen(), &moving);
    }
  }
  const MaskImage& find(const SeenFrame& frame_seen, const MaskImage* moving,
                        LookedAt looked_at = LookedAt::kPicture, const PixelBox& box = kAll) {
    if (moving == nullptr) return mask.find_nothing(frame_seen, box);
    return mask.find(frame_seen, Rigid3::Identity(), *moving, looked_at, *scene, space, box);
  }

  std::mt19937_64 random = test::random_case(3);
  FreeSpace space{kNoise};
  SurfaceMap map{kNoise};
  std::optional<AnchoredScene> scene;
  PressingMask mask{kNoise};
  PixelBox things;  // px of the picture; empty: only the wall
  float thing_z = 0.6f;
  int frame = 0;
};

const MaskImage kNothingMoves(kCamera.width, kCamera.height, 0);

long count(const MaskImage& shows, std::uint8_t what) {
  return std::count(shows.begin(), shows.end(), what);
}

TEST_CASE("the room in which the body was anchored does not press", "[seen_object][presses]") {
  Room room;
  room.things = {60, 30, 40, 40};  // it was there from the beginning
  room.show(60);
  CHECK(count(room.find(room.seen(), &kNothingMoves), kShowsPresser) == 0);
  CHECK(count(room.find(room.seen(), &kNothingMoves), kShowsRoom) ==
        kCamera.width * kCamera.height);
}

TEST_CASE("what moves presses where it is measured, and is unknown where it is not",
          "[seen_object][presses]") {
  Room room;
  room.show(20);
  room.things = {8, 8, 40, 24};
  SeenFrame frame = room.seen();
  MaskImage moving(kCamera.width, kCamera.height, 0);
  for (int y = 8; y < 32; ++y) {
    for (int x = 8; x < 48; ++x) moving(x, y) = 255;
  }
  frame.depth(12, 12) = kNone;
  frame.depth(80, 80) = kNone;
  // A group counts from its third frame on.
  CHECK(count(room.find(frame, &moving), kShowsPresser) == 0);
  CHECK(count(room.find(frame, &moving), kShowsPresser) == 0);
  const MaskImage& shows = room.find(frame, &moving);
  CHECK(shows(20, 15) == kShowsPresser);
  CHECK(shows(12, 12) == kShowsUnknown);
  CHECK(shows(80, 80) == kShowsRoom);  // it looks as the room did
  CHECK(count(shows, kShowsPresser) == 959);
  CHECK(room.find(frame, &moving, LookedAt::kNothing)(80, 80) == kShowsUnknown);
}

TEST_CASE("a few tiles that seem to move, and any in a single frame, do not press",
          "[seen_object][presses]") {
  Room room;
  room.show(20);
  MaskImage moving(kCamera.width, kCamera.height, 0);
  for (int y = 8; y < 20; ++y) {
    for (int x = 8; x < 28; ++x) moving(x, y) = 255;  // 15 tiles
  }
  for (int i = 0; i < 6; ++i) CHECK(count(room.find(room.seen(), &moving), kShowsPresser) == 0);
  // At the other end of the picture in each frame: never near the group of the last frame.
  Room other;
  other.show(20);
  for (int i = 0; i < 6; ++i) {
    MaskImage elsewhere(kCamera.width, kCamera.height, 0);
    for (int y = 8; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) elsewhere(i % 2 == 0 ? x : x + 110, y) = 255;
    }
    CHECK(count(other.find(other.seen(), &elsewhere), kShowsPresser) == 0);
  }
}

TEST_CASE("what was put before the room presses, also when it has become part of the map",
          "[seen_object][presses]") {
  Room room;
  room.show(40);
  room.things = {60, 30, 40, 40};
  room.come();
  for (const int frames : {0, 60, 700}) {
    room.show(frames);
    INFO("rests for " << frames << " frames");
    const MaskImage& shows = room.find(room.seen(), &kNothingMoves);
    CHECK(count(shows, kShowsPresser) > 1500);
    CHECK(count(shows, kShowsPresser) <= 1600);
    CHECK(shows(80, 50) == kShowsPresser);
    CHECK(shows(30, 50) == kShowsRoom);
  }
  room.things = {};
  room.show(30);
  CHECK(count(room.find(room.seen(), &kNothingMoves), kShowsPresser) == 0);
}

TEST_CASE("a strip of the room with a near thing's depth, and doubtful pixels, do not press",
          "[seen_object][presses]") {
  Room room;
  room.show(40);
  room.things = {60, 30, 2, 60};
  for (int i = 0; i < 5; ++i) {
    CHECK(count(room.find(room.seen(), &kNothingMoves), kShowsPresser) == 0);
  }
  room.things = {60, 30, 40, 40};
  room.come();
  const auto pressers_with = [&](std::uint8_t confidence) {
    SeenFrame frame = room.seen();
    frame.confidence = GrayImage(kCamera.width, kCamera.height, confidence);
    for (int i = 0; i < 3; ++i) (void)room.find(frame, &kNothingMoves);
    return count(room.find(frame, &kNothingMoves), kShowsPresser);
  };
  CHECK(pressers_with(32) == 0);
  CHECK(pressers_with(200) > 1500);
}

TEST_CASE("a thin thing that moves presses, however it lies on the tiles",
          "[seen_object][presses]") {
  for (int x0 = 60; x0 < 64; ++x0) {
    INFO("from column " << x0);
    Room room;
    room.show(20);
    room.things = {x0, 8, 5, 80};
    SeenFrame frame = room.seen();
    MaskImage moving(kCamera.width, kCamera.height, 0);
    // Along outlines a matcher's confidence is low.
    frame.confidence = GrayImage(kCamera.width, kCamera.height, 255);
    for (int y = 8; y < 88; ++y) {
      for (int x = x0; x < x0 + 5; ++x) moving(x, y) = 255;
      frame.confidence(x0, y) = frame.confidence(x0 + 4, y) = 100;
    }
    for (int i = 0; i < 2; ++i) CHECK(count(room.find(frame, &moving), kShowsPresser) == 0);
    CHECK(count(room.find(frame, &moving), kShowsPresser) == 400);
    // When only a quarter of it moves, it may be a mismatch.
    Room other;
    other.show(20);
    for (int y = 28; y < 88; ++y) {
      for (int x = x0; x < x0 + 5; ++x) moving(x, y) = 0;
    }
    for (int i = 0; i < 4; ++i) CHECK(count(other.find(frame, &moving), kShowsPresser) == 0);
  }
}

TEST_CASE("the end of a moving thing stays a presser where the moving mask takes it for the scene",
          "[seen_object][presses]") {
  Room room;
  room.show(40);
  room.things = {60, 20, 8, 60};
  room.come();
  MaskImage moving(kCamera.width, kCamera.height, 0);
  for (int y = 20; y < 68; ++y) {
    for (int x = 60; x < 68; ++x) moving(x, y) = 255;
  }
  // Its last twelve rows are not in the moving mask, as a pencil's tip before wood.
  for (int i = 0; i < 5; ++i) CHECK(room.find(room.seen(), &moving)(63, 76) == kShowsPresser);
  room.things.height = 48;
  CHECK(room.find(room.seen(), &moving)(63, 76) == kShowsRoom);
  room.things.height = 60;  // but it was shorter in the frame before
  CHECK(room.find(room.seen(), &moving)(63, 76) == kShowsRoom);
}

TEST_CASE("the resting part of a hand that moves presses with it", "[seen_object][presses]") {
  Room room;
  room.show(40);
  room.things = {60, 20, 16, 60};
  MaskImage moving(kCamera.width, kCamera.height, 0);
  for (int y = 20; y < 56; ++y) {
    for (int x = 60; x < 76; ++x) moving(x, y) = 255;
  }
  // The lower part never moved, so it may be a mismatch.
  for (int i = 0; i < 4; ++i) (void)room.find(room.seen(), &moving);
  CHECK(room.find(room.seen(), &moving)(66, 40) == kShowsPresser);
  CHECK(room.find(room.seen(), &moving)(66, 70) == kShowsRoom);
  room.come();
  const MaskImage& shows = room.find(room.seen(), &moving);
  CHECK(shows(66, 40) == kShowsPresser);
  CHECK(shows(66, 70) == kShowsPresser);
  CHECK(shows(40, 70) == kShowsRoom);
}

TEST_CASE("with a walking camera only things clearly in front of the room press",
          "[seen_object][presses]") {
  for (const float before : {0.025f, 0.080f}) {
    INFO("by " << before << " m");
    Room room;
    room.show(40);
    room.things = {40, 20, 60, 60};
    room.thing_z = kWall - before;
    MaskImage moving(kCamera.width, kCamera.height, 0);
    for (int y = 20; y < 80; ++y) {
      for (int x = 40; x < 100; ++x) moving(x, y) = 255;
    }
    for (int i = 0; i < 4; ++i) (void)room.find(room.seen(), &moving, LookedAt::kNothing);
    const MaskImage& shows = room.find(room.seen(), &moving, LookedAt::kNothing);
    CHECK((shows(70, 50) == kShowsPresser) == (before > 0.05f));
  }
}

TEST_CASE("what is too close is in front of everything and presses nothing",
          "[seen_object][presses]") {
  Room room;
  room.show(20);
  SeenFrame frame = room.seen();
  frame.too_close = MaskImage(kCamera.width, kCamera.height, 0);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      frame.too_close(x, y) = 255;
      frame.depth(x, y) = kNone;
    }
  }
  const MaskImage& shows = room.find(frame, &kNothingMoves);
  CHECK(shows(20, 20) == kShowsUnknown);
  CHECK(count(shows, kShowsUnknown) == 1600);
}

TEST_CASE("without a moving mask, and outside of the box, nothing is known",
          "[seen_object][presses]") {
  Room room;
  room.show(20);
  CHECK(count(room.find(room.seen(), nullptr), kShowsUnknown) == kCamera.width * kCamera.height);
  const MaskImage& shows =
      room.find(room.seen(), &kNothingMoves, LookedAt::kPicture, {10, 20, 30, 40});
  CHECK(count(shows, kShowsRoom) == 1200);
  CHECK(shows(10, 20) == kShowsRoom);
  CHECK(shows(39, 59) == kShowsRoom);
  CHECK(count(room.mask.find_all(room.seen(), {10, 20, 30, 40}), kShowsPresser) == 1200);
}

TEST_CASE("finding what presses allocates nothing after the first frame, and refuses odd settings",
          "[seen_object][presses][frame loop]") {
  Room room;
  room.show(40);
  room.things = {60, 30, 40, 40};
  const SeenFrame frame = room.seen();
  (void)room.find(frame, &kNothingMoves);
  CHECK(test::allocations_during([&] { (void)room.find(frame, &kNothingMoves); }) == 0);
  CHECK_THROWS_AS(PressingMask(kNoise, {.step = 0}), ContractViolation);
  CHECK_THROWS_AS(PressingMask(kNoise, {.sigmas = -1}), ContractViolation);
  const MaskImage small(3, 3, 0);
  CHECK_THROWS_AS(room.find(frame, &small), ContractViolation);
}

}  // namespace
}  // namespace palpable
