#include "palpable/live/map/anchored_scene.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

const PinholeCamera kCamera{320, 180, 170, 170, 165.2, 88.1};
const DepthNoise kNoise{0, 0, 0.012};

// World frame: Y points down. A desk is 0.3 m below the first camera, a wall 1.5 m in front of it,
// and another 1.2 m to its right.
constexpr double kDesk = 0.3, kWall = 1.5, kRightWall = 1.2;

// A box. cup_at() is one that stands on the desk, 12 cm high.
struct Box {
  Vector3d low, high;
};
Box cup_at(double x, double z) {
  return {{x - 0.04, kDesk - 0.12, z - 0.04}, {x + 0.04, kDesk, z + 0.04}};
}

// Reduces t to where the ray origin + t direction meets the box, if it does so before t.
void meet(const Box& box, const Vector3d& origin, const Vector3d& direction, double& t) {
  double in = 0, out = t;
  for (int k = 0; k < 3; ++k) {
    double a = (box.low[k] - origin[k]) / direction[k],
           b = (box.high[k] - origin[k]) / direction[k];
    if (a > b) std::swap(a, b);
    in = std::max(in, a);
    out = std::min(out, b);
  }
  if (in < out) t = in;
}

// A room with a camera, its map and its free space; anchor() anchors the body.
struct Room {
  explicit Room(unsigned seed, int frames_to_settle = 600)
      : random(test::random_case(seed)),
        space(kNoise, FreeSpaceSettings{.frames_to_settle = frames_to_settle}) {}

  DepthImage depth_from(const PinholeCamera& camera) {
    std::normal_distribution<double> normal;
    DepthImage depth(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Vector3d eye = world_from_camera.translation();
        const Vector3d ray = world_from_camera.linear() * camera.unproject(x, y, 1);
        double Z = 10;
        if (ray.y() > 0) Z = std::min(Z, (kDesk - eye.y()) / ray.y());
        if (ray.z() > 0) Z = std::min(Z, (kWall - eye.z()) / ray.z());
        if (ray.x() > 0) Z = std::min(Z, (kRightWall - eye.x()) / ray.x());
        for (const Box& box : boxes) meet(box, eye, ray, Z);
        depth(x, y) = static_cast<float>(Z + 0.3 * kNoise.sigma(Z) * normal(random));
      }
    }
    return depth;
  }
  // Shows frames without a mask: objects that arrived are fused as if they had settled.
  void show(int frames) {
    for (int i = 0; i < frames; ++i) {
      const PinholeCamera rays = kCamera.scaled_down(8);
      space.add(rays, moved * world_from_camera, depth_from(rays));
      if (frame++ % 3 != 0) continue;
      map.fuse(depth_from(kCamera), kCamera, moved * world_from_camera);
      if (scene) scene->update(map, space);
    }
  }
  void anchor() { scene.emplace(map); }
  // Closes a loop: the whole room moves by `step` in the world frame.
  void close_loop(const Rigid3& step) {
    scene->follow(std::vector<Correction>{{0, step}});
    map.clear();
    space = FreeSpace(kNoise, space.settings());
    moved = step * moved;
  }

  // The share of the measured points p with on(p) for which was_there() is true.
  template <class On>
  double share_there(const On& on) {
    const DepthImage depth = depth_from(kCamera);
    AnchoredScene::Reader reader(*scene, space);
    int all = 0, there = 0;
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        const auto Z = static_cast<double>(depth(x, y));
        const Vector3d p = world_from_camera * kCamera.unproject(x, y, Z);
        if (!on(p) || Z > 2) continue;
        ++all;
        const double error = std::max(0.015, 4 * kNoise.sigma(Z));
        there += reader.was_there((moved * p).cast<float>(), static_cast<float>(error)) ? 1 : 0;
      }
    }
    REQUIRE(all > 100);
    return static_cast<double>(there) / all;
  }

  std::mt19937_64 random;
  SurfaceMap map{kNoise};
  FreeSpace space;
  std::optional<AnchoredScene> scene;
  Rigid3 world_from_camera = Rigid3::Identity();
  Rigid3 moved = Rigid3::Identity();  // from the room's frame to that of map and scene
  std::vector<Box> boxes;
  int frame = 0;
};

// Pixels of the cup that are not close to the desk. 73 of these 581 are at its sides and its top,
// where a voxel may contain the distance of something beside the cup.
constexpr double kCupPoints = 581;
const double kAllButOutline =
    1 - tolerance(24 / kCupPoints, "a third of the outline; 15 and 11 px as measured");

constexpr double kPoints = 320 * 180;
// Share of all points with the cup in the room, except those at its outline, 21 x 31 px.
const double kAllButRim = 1 - tolerance(2 * (21 + 31) / kPoints, "a pixel along the outline");
const double kAllButPoints = 1 - tolerance(3 / kPoints, "0 to 2 single points with six seeds");

bool anywhere(const Vector3d&) { return true; }

// Whether a point is on the cup, and so far above the desk that it cannot be a point of the desk.
bool on_cup(const Vector3d& p) {
  return p.y() < kDesk - 0.03 && p.y() > kDesk - 0.13 && p.z() < 0.9 && std::abs(p.x()) < 0.06;
}
bool beside_cup(const Vector3d& p) { return !on_cup(p) && !(p.y() < kDesk - 0.02 && p.z() < 0.9); }

TEST_CASE("what the map held when the body was anchored was there", "[map][anchored]") {
  Room room(1);
  room.boxes = {cup_at(0, 0.7)};
  room.show(60);
  room.anchor();
  CHECK(room.share_there(anywhere) >= kAllButRim);
  room.show(60);
  CHECK(room.share_there(anywhere) >= kAllButRim);
  CHECK(room.share_there(on_cup) > kAllButOutline);
}

TEST_CASE("a body that is anchored before anything was mapped has the room around it as well",
          "[map][anchored]") {
  Room room(2);
  room.anchor();
  room.show(90);
  CHECK(room.share_there(anywhere) >= kAllButPoints);
}

TEST_CASE("a cup that is put down later was not there, also when the map has taken it in",
          "[map][anchored]") {
  for (const bool anchored_at_once : {false, true}) {
    Room room(3, 60);
    if (anchored_at_once) room.anchor();
    room.show(60);
    if (!anchored_at_once) room.anchor();
    room.boxes = {cup_at(0, 0.7)};
    CHECK(room.share_there(on_cup) == 0);
    CHECK(room.share_there(beside_cup) >= kAllButRim);
    room.show(600);  // only some of the frames have a ray that ends in a given cell
    // The map contains the cup, and its space is no longer free.
    const Vector3d front(0, kDesk - 0.1, 0.66);
    REQUIRE(room.map.distance(front).has_value());
    REQUIRE(std::abs(*room.map.distance(front)) < 0.02);
    REQUIRE_FALSE(room.space.is_free(front + Vector3d(0, 0, 0.005)));
    CHECK(room.share_there(on_cup) == 0);
    CHECK(room.share_there(beside_cup) >= kAllButRim);
  }
}

TEST_CASE("a cup that had settled before the body was anchored was there", "[map][anchored]") {
  Room room(4, 60);
  room.show(60);
  room.boxes = {cup_at(0, 0.7)};
  room.show(300);
  room.anchor();
  CHECK(room.share_there(on_cup) > kAllButOutline);
}

TEST_CASE("a wall that is discovered later was there, what comes before it was not",
          "[map][anchored]") {
  Room room(5);
  room.show(60);
  room.anchor();
  const auto on_right_wall = [](const Vector3d& p) { return p.x() > kRightWall - 0.1; };
  for (int n = 0; n <= 30; ++n) {
    room.world_from_camera = Rigid3(Eigen::AngleAxisd(1.4 * n / 30, Vector3d::UnitY()));
    room.show(3);
  }
  CHECK(room.share_there(anywhere) >= kAllButPoints);
  CHECK(room.share_there(on_right_wall) == 1);
  room.show(60);
  room.boxes = {{{0.6, -0.1, -0.1}, {0.62, 0.1, 0.1}}};
  CHECK(room.share_there([](const Vector3d& p) { return p.x() < 0.7 && p.y() < 0.12; }) == 0);
  CHECK(room.share_there(on_right_wall) == 1);
}

TEST_CASE("what is taken away and comes back was not there", "[map][anchored]") {
  Room room(6);
  room.boxes = {cup_at(0, 0.7)};
  room.show(60);
  room.anchor();
  room.boxes.clear();
  room.show(120);
  CHECK(room.share_there(anywhere) == 1);
  room.boxes = {cup_at(0, 0.7)};
  CHECK(room.share_there(on_cup) == 0);
}

TEST_CASE("what is remembered follows when a loop is closed, and what had come has still come",
          "[map][anchored]") {
  Room room(9, 60);
  room.show(60);
  room.anchor();
  room.boxes = {cup_at(0, 0.7)};
  room.show(300);
  const int blocks = room.scene->blocks();
  const Rigid3 step = Eigen::Translation3d(0.113, -0.026, 0.055) *
                      Rigid3(Eigen::AngleAxisd(0.1, Vector3d(0.6, 0.8, 0)));
  room.close_loop(step);
  // Without new frames after the loop, with some, and when the map contains everything again.
  for (const int frames : {0, 30, 300}) {
    INFO(frames << " frames");
    room.show(frames);
    CHECK(room.share_there(on_cup) == 0);
    CHECK(room.share_there(beside_cup) >= kAllButRim);
    CHECK(room.scene->blocks() <
          2 * blocks);  // a surface in one block can move into two; 1.6 as measured
  }
  room.boxes.clear();
  room.show(300);
  CHECK(room.share_there(anywhere) >= kAllButPoints);
}

TEST_CASE("what is taken away after a loop was closed, and comes back, was not there",
          "[map][anchored]") {
  Room room(10);
  room.boxes = {cup_at(0, 0.7)};
  room.show(60);
  room.anchor();
  room.close_loop(Rigid3(Eigen::Translation3d(0.113, -0.026, 0.055)));
  CHECK(room.share_there(on_cup) >
        1 - tolerance(36 / kCupPoints,
                      "half of the outline: distances have moved to the nearest voxel; 26 px as "
                      "measured"));
  room.boxes.clear();
  room.show(120);
  room.boxes = {cup_at(0, 0.7)};
  CHECK(room.share_there(on_cup) == 0);
}

TEST_CASE("each block follows the keyframe by which it was placed, and the older one counts",
          "[map][anchored]") {
  // The left half of the picture shows a wall that is placed by the first keyframe. The right half
  // shows one 0.2 m farther, placed by the keyframe of frame 12.
  SurfaceMap map(kNoise);
  FreeSpace space(kNoise);
  AnchoredScene scene(map);
  const auto see = [&](int from_x, float Z, int keyframe) {
    DepthImage depth(kCamera.width, kCamera.height, std::numeric_limits<float>::quiet_NaN());
    for (int y = 0; y < kCamera.height; ++y) std::fill_n(&depth(from_x, y), kCamera.width / 2, Z);
    map.fuse(depth, kCamera, Rigid3::Identity());
    scene.update(map, space, keyframe);
  };
  see(0, 0.805F, 0);
  see(kCamera.width / 2, 1.005F, 12);
  const auto lies_at = [&](double x, double Z) {
    const auto there = [&](double z) { return scene.was_there({x, 0, z}, 0.006, space); };
    return there(Z) && !there(Z - 0.02);
  };
  REQUIRE((lies_at(-0.2, 0.805) && lies_at(0.2, 1.005)));
  const auto by = [](double x, double z) { return Rigid3(Eigen::Translation3d(x, 0, z)); };
  scene.follow(std::vector<Correction>{{0, by(0, 0)}, {10, by(0.1, 0.1)}, {20, by(0, 0.3)}});
  CHECK((lies_at(-0.2, 0.805) && lies_at(0.3, 1.105)));
  CHECK_FALSE(lies_at(0.2, 1.005));
  // Now the second wall is moved in front of the first, to within 20 mm.
  scene.follow(std::vector<Correction>{{0, by(0, 0)}, {10, by(-0.5, -0.28)}});
  CHECK(lies_at(-0.2, 0.805));
  CHECK_FALSE(lies_at(-0.2, 0.825));
}

TEST_CASE("space that was never in view belongs to the room", "[map][anchored]") {
  Room room(7);
  room.anchor();
  CHECK(room.scene->was_there({0, 0, 1}, 0.015, room.space));
  CHECK(room.scene->was_there({1e6, 0, 1}, 0.015, room.space));
  CHECK(room.scene->was_there(Vector3d::Constant(std::nan("")), 0.015, room.space));
}

TEST_CASE("queries do not allocate, and single queries agree with the reader", "[map][anchored]") {
  Room room(8);
  room.show(30);
  room.anchor();
  AnchoredScene::Reader reader(*room.scene, room.space);
  int there = 0;
  CHECK(test::allocations_during([&] {
          for (int i = 0; i < 1000; ++i) {
            const Eigen::Vector3f p(0, 0.0003F * static_cast<float>(i), 0.6F);
            const bool was = reader.was_there(p, 0.015F);
            there += was ? 1 : 0;
          }
        }) == 0);
  int again = 0;
  for (int i = 0; i < 1000; ++i) {
    again += room.scene->was_there({0, static_cast<double>(0.0003F * static_cast<float>(i)), 0.6},
                                   0.015, room.space)
                 ? 1
                 : 0;
  }
  CHECK(there == again);
  // The points are 0.3 mm apart and the last is on the desk: those within 15 mm of it were there.
  CHECK(std::abs(0.0003 * there - 0.015) <=
        tolerance(0.0053, "half a voxel of 10 mm, and a step of the points"));
}

TEST_CASE("free space remembers that it was free where something has settled",
          "[map][free_space]") {
  FreeSpace space(kNoise, FreeSpaceSettings{.frames_to_settle = 20});
  const PinholeCamera rays = kCamera.scaled_down(8);
  const Vector3d at(0, 0, 0.8);
  const auto see = [&](float Z, int frames) {
    for (int i = 0; i < frames; ++i) {
      space.add(rays, Rigid3::Identity(), DepthImage(rays.width, rays.height, Z));
    }
  };
  CHECK_FALSE(space.was_free(at));
  see(1.5F, 60);
  CHECK((space.is_free(at) && space.was_free(at)));
  see(0.8F, 200);
  CHECK_FALSE(space.is_free(at));
  CHECK(space.was_free(at));
  CHECK_FALSE(space.was_free({0, 0, 1.6}));
}

}  // namespace
}  // namespace palpable
