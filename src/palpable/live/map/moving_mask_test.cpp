#include "palpable/live/map/moving_mask.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <random>

namespace palpable {
namespace {

const float kNaN = std::nanf("");
const PinholeCamera kCamera{320, 180, 170, 170, 165.2, 88.1};
const DepthNoise kNoise{0, 0, 0.012};

// A desk 0.3 m below the camera in front of a wall at 1.5 m, with the noise of the model.
DepthImage desk(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  DepthImage depth(kCamera.width, kCamera.height);
  for (int y = 0; y < kCamera.height; ++y) {
    const double slope = (y - kCamera.cy_px) / kCamera.fy_px;
    const double Z = slope > 0.2 ? 0.3 / slope : 1.5;
    for (int x = 0; x < kCamera.width; ++x) {
      depth(x, y) = static_cast<float>(Z + 0.3 * kNoise.sigma(Z) * normal(random));
    }
  }
  return depth;
}

struct Scene {
  explicit Scene(unsigned seed) : random(test::random_case(seed)) { seen.depth_camera = kCamera; }
  // One frame through mask, free space and map. The hand covers a rectangle.
  const MaskImage& show(const DepthImage& depth) {
    seen.depth = depth;
    const MaskImage& mask = mover.find(seen, Rigid3::Identity(), &map);
    mover.learn(Rigid3::Identity());
    if (frame++ % 3 == 0) map.fuse(depth, kCamera, Rigid3::Identity(), mask);
    return mask;
  }
  void learn_desk(int frames) {
    for (int i = 0; i < frames; ++i) show(desk(random));
  }
  std::mt19937_64 random;
  SeenFrame seen;
  MovingMask mover{kNoise};
  SurfaceMap map{kNoise};
  int frame = 0;
};

void cover(DepthImage& depth, int x0, int y0, int x1, int y1, float Z) {
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) depth(x, y) = Z;
  }
}

int set(const MaskImage& mask) {
  int count = 0;
  for (const std::uint8_t value : mask) count += value != 0 ? 1 : 0;
  return count;
}

TEST_CASE("a hand where the scene was seen free moves, to the pixel", "[map][moving_mask]") {
  Scene scene(1);
  scene.learn_desk(40);
  DepthImage depth = desk(scene.random);
  cover(depth, 101, 50, 183, 121, 0.4F);
  // A hole inside the hand, and a strip of unknown depth at its left.
  cover(depth, 130, 70, 140, 80, kNaN);
  cover(depth, 81, 50, 101, 121, kNaN);
  const MaskImage& mask = scene.show(depth);
  int wrong = 0;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const bool hand = x >= 101 && x < 183 && y >= 50 && y < 121;
      // The mask may extend into unknown pixels by its margin only.
      const bool margin = x >= 101 - scene.mover.settings().grow_px && x < 101;
      if (!margin && hand != (mask(x, y) != 0)) ++wrong;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a scene in which nothing moves has an empty mask", "[map][moving_mask]") {
  Scene scene(2);
  int found = 0;
  for (int i = 0; i < 60; ++i) found += set(scene.show(desk(scene.random)));
  CHECK(found == 0);
}

TEST_CASE("a thing that is put on the desk moves although no cell there was free",
          "[map][moving_mask]") {
  Scene scene(3);
  scene.learn_desk(40);
  DepthImage depth = desk(scene.random);
  // 35 mm in front of the desk, which is 0.6 m away there: within the margin of the free space.
  const int y0 = 164, y1 = 176;
  for (int y = y0; y < y1; ++y) {
    for (int x = 100; x < 160; ++x) depth(x, y) -= 0.035F;
  }
  const MaskImage& mask = scene.show(depth);
  int hit = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = 100; x < 160; ++x) hit += mask(x, y) != 0 ? 1 : 0;
  }
  CHECK(hit >=
        test::tolerance(0.8, "tiles of 4 px that are mostly desk, at the rim of 12 rows") * 720);
}

TEST_CASE("what is too close to have a depth moves", "[map][moving_mask]") {
  Scene scene(4);
  scene.learn_desk(40);
  DepthImage depth = desk(scene.random);
  cover(depth, 80, 40, 200, 140, kNaN);
  scene.seen.too_close = MaskImage(kCamera.width, kCamera.height);
  for (int y = 40; y < 140; ++y) {
    for (int x = 80; x < 200; ++x) scene.seen.too_close(x, y) = 255;
  }
  // Its sides lie between tiles; the mask only grows into pixels without a depth.
  CHECK(set(scene.show(depth)) == 120 * 100);
}

// Paints a grey picture of the desk, with a hand in a rectangle.
void paint(SeenFrame& seen, std::mt19937_64& random, int x0 = 0, int y0 = 0, int x1 = 0,
           int y1 = 0) {
  std::normal_distribution<double> normal(0, 0.7);
  seen.left.resize(kCamera.width, kCamera.height);
  seen.color.resize(kCamera.width, kCamera.height);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const bool hand = x >= x0 && x < x1 && y >= y0 && y < y1;
      const double level = hand ? 170 : 100 + (x * 7 + y * 13) % 31;
      const auto value = static_cast<std::uint8_t>(std::lround(level + normal(random)));
      seen.left(x, y) = value;
      seen.color(x, y) = {value, static_cast<std::uint8_t>(hand ? 120 : value), value};
    }
  }
}

// Shows the desk and its picture for long enough that both are known.
void learn_picture(Scene& scene) {
  for (int i = 0; i < 40; ++i) {
    paint(scene.seen, scene.random);
    scene.show(desk(scene.random));
  }
}

TEST_CASE("what has no depth and does not look as the scene did moves", "[map][moving_mask]") {
  Scene scene(8);
  learn_picture(scene);
  DepthImage depth = desk(scene.random);
  // A hand without depth, and a rectangle without depth that looks as before.
  cover(depth, 100, 48, 180, 120, kNaN);
  cover(depth, 220, 48, 280, 120, kNaN);
  paint(scene.seen, scene.random, 100, 48, 180, 120);
  const MaskImage& mask = scene.show(depth);
  int hit = 0;
  for (int y = 48; y < 120; ++y) {
    for (int x = 100; x < 180; ++x) hit += mask(x, y) != 0 ? 1 : 0;
  }
  CHECK(hit == 80 * 72);
  CHECK(set(mask) - hit <=
        test::tolerance(2, "px round it: a pixel is seen with its eight neighbours") * (80 + 72));
}

TEST_CASE("a hand that a matcher made too wide is cut to its look", "[map][moving_mask]") {
  Scene scene(9);
  learn_picture(scene);
  DepthImage depth = desk(scene.random);
  cover(depth, 90, 48, 180, 120, 0.4F);  // 10 px too far to the left
  paint(scene.seen, scene.random, 100, 48, 180, 120);
  const MaskImage& mask = scene.show(depth);
  int wrong = 0;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const bool hand = x >= 100 && x < 180 && y >= 48 && y < 120;
      wrong += hand != (mask(x, y) != 0) ? 1 : 0;
    }
  }
  CHECK(wrong <= test::tolerance(1, "px at its left border, which is 72 px long") * 72);
}

// A wall, and below it white paper without depth, except where place() sets one.
struct Paper : Scene {
  static constexpr int kEdge = 60;           // its first row
  static constexpr int kRows = 180 - kEdge;  // whole tiles
  explicit Paper(unsigned seed) : Scene(seed), depth(kCamera.width, kCamera.height, 1.5F) {
    place(0, kCamera.width, kNaN);
  }
  // Sets the depth of the paper's columns x0 .. x1.
  void place(int x0, int x1, float Z) { cover(depth, x0, kEdge, x1, kCamera.height, Z); }
  // Shows a frame with a hand in columns x0 .. x1 of the picture; place() determines the depth.
  void show_paper(int x0 = 0, int x1 = 0) {
    std::normal_distribution<double> normal(0, 0.7);
    seen.left.resize(kCamera.width, kCamera.height);
    seen.color.resize(kCamera.width, kCamera.height);
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        const bool hand = y >= kEdge && x >= x0 && x < x1;
        const double level = hand ? 140 : y < kEdge ? 100 + (x * 7 + y * 13) % 31 : 220;
        const auto value = static_cast<std::uint8_t>(std::lround(level + normal(random)));
        seen.left(x, y) = value;
        seen.color(x, y) = {value, static_cast<std::uint8_t>(hand ? 100 : value), value};
      }
    }
    show(depth);
  }
  // The number of marked pixels in columns x0 .. x1.
  int borrowed(int x0, int x1) {
    int count = 0;
    for (int y = 0; y < kCamera.height; ++y)
      for (int x = x0; x < x1; ++x) count += mover.borrowed()(x, y) != 0 ? 1 : 0;
    return count;
  }
  DepthImage depth;
};

TEST_CASE("a depth that bare paper copies from a hand beside it is marked as borrowed",
          "[map][moving_mask]") {
  Paper paper(21);
  for (int i = 0; i < 70; ++i) paper.show_paper();
  CHECK(set(paper.mover.borrowed()) == 0);
  paper.place(100, 240, 0.4F);
  paper.show_paper(180, 240);
  CHECK(paper.borrowed(104, 176) == 72 * Paper::kRows);
  CHECK(paper.borrowed(180, 240) == 0);
  CHECK(set(paper.mover.borrowed()) <= 80 * Paper::kRows);
}

TEST_CASE("what stood before bare paper from the start keeps its depth, however plain it is",
          "[map][moving_mask]") {
  Paper paper(22);
  paper.place(100, 180, 0.4F);
  for (int i = 0; i < 120; ++i) {
    paper.show_paper();
    // Except in the outermost tiles, where voxels are visible beside it.
    CHECK(paper.borrowed(104, 176) == 0);
  }
}

TEST_CASE("no depth is marked as borrowed before the map could contain it", "[map][moving_mask]") {
  Paper paper(23);
  for (int i = 0; i < 20; ++i) paper.show_paper();
  paper.place(100, 240, 0.4F);
  paper.show_paper(180, 240);
  CHECK(set(paper.mover.borrowed()) == 0);
}

TEST_CASE("a plain thing that was put down keeps its depth", "[map][moving_mask]") {
  Paper paper(24);
  for (int i = 0; i < 70; ++i) paper.show_paper();
  paper.place(180, 240, 0.4F);
  // Longer than the picture needs to learn the thing.
  for (int i = 0; i < 700; ++i) {
    paper.show_paper(180, 240);
    CHECK(paper.borrowed(180, 240) == 0);
  }
}

TEST_CASE("a camera that moves goes by depth alone", "[map][moving_mask]") {
  Scene scene(10);
  learn_picture(scene);
  DepthImage depth = desk(scene.random);
  cover(depth, 100, 48, 180, 120, kNaN);
  paint(scene.seen, scene.random, 100, 48, 180, 120);
  scene.seen.depth = depth;
  Rigid3 moved = Rigid3::Identity();
  moved.translation().x() = 0.001;  // shifts things at 0.3 m by 0.6 px
  CHECK(set(scene.mover.find(scene.seen, moved, &scene.map)) == 0);
}

// Paints a wall at 0.8 m with texture at all scales, seen from `shift` m to the right, with a hand
// in front of it that has no depth.
void paint_wall(Scene& scene, double shift, bool with_hand) {
  std::normal_distribution<double> normal(0, 0.7);
  const double Z = 0.8;
  SeenFrame& seen = scene.seen;
  seen.depth.resize(kCamera.width, kCamera.height);
  seen.left.resize(kCamera.width, kCamera.height);
  seen.color.resize(kCamera.width, kCamera.height);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const bool on = with_hand && x >= 100 && x < 180 && y >= 48 && y < 120;
      const double u = x + kCamera.fx_px * shift / Z;
      const double level = 110 + 18 * std::sin(0.9 * u) + 12 * std::sin(0.11 * u + 0.3 * y);
      const auto value =
          static_cast<std::uint8_t>(std::lround((on ? 170 : level) + normal(scene.random)));
      seen.left(x, y) = value;
      seen.color(x, y) = {value, static_cast<std::uint8_t>(on ? 120 : value), value};
      seen.depth(x, y) = on ? kNaN : static_cast<float>(Z);
    }
  }
}

// The pose of frame `i` of a camera that moves to and fro along the wall.
Rigid3 swaying_pose(int i) { return Rigid3(Eigen::Translation3d(0.02 * std::sin(0.2 * i), 0, 0)); }

const MaskImage& show_wall(Scene& scene, bool with_hand) {
  const Rigid3 pose = swaying_pose(scene.frame);
  paint_wall(scene, pose.translation().x(), with_hand);
  const MaskImage& mask = scene.mover.find(scene.seen, pose, &scene.map);
  scene.mover.learn(pose);
  if (scene.frame++ % 3 == 0) scene.map.fuse(scene.seen.depth, kCamera, pose, mask);
  return mask;
}

TEST_CASE("a camera that sways tells a hand without depth by its look", "[map][moving_mask]") {
  Scene scene(12);
  int idle = 0;
  for (int i = 0; i < 90; ++i) idle += set(show_wall(scene, false));
  CHECK(idle == 0);
  for (int i = 90; i < 99; ++i) {
    const MaskImage& mask = show_wall(scene, true);
    if (i < 93) continue;  // without any depth it is noticed only in every fourth frame
    int hit = 0;
    for (int y = 48; y < 120; ++y) {
      for (int x = 100; x < 180; ++x) hit += mask(x, y) != 0 ? 1 : 0;
    }
    CHECK(hit >= test::tolerance(0.98, "a pixel at the border may look like the wall") * 80 * 72);
    CHECK(set(mask) - hit <= test::tolerance(4, "px round it: it has no depth") * 2 * (80 + 72));
  }
}

TEST_CASE("a camera that has swayed and rests for a frame sees the hand", "[map][moving_mask]") {
  Scene scene(11);
  Rigid3 pose = Rigid3::Identity();
  for (int i = 0; i < 40; ++i) {
    paint(scene.seen, scene.random);
    scene.seen.depth = desk(scene.random);
    pose.translation().x() = i % 2 == 0 ? 0.001 : 0.0;  // shifts things at 0.3 m by 0.6 px
    const MaskImage& mask = scene.mover.find(scene.seen, pose, &scene.map);
    scene.mover.learn(pose);
    if (i % 3 == 0) scene.map.fuse(scene.seen.depth, kCamera, pose, mask);
  }
  cover(scene.seen.depth, 100, 48, 180, 120, 0.4F);
  paint(scene.seen, scene.random, 100, 48, 180, 120);
  CHECK(set(scene.mover.find(scene.seen, pose, &scene.map)) >= 80 * 72);
}

TEST_CASE("at the start nothing is known to be free, and nothing moves", "[map][moving_mask]") {
  Scene scene(5);
  DepthImage depth = desk(scene.random);
  cover(depth, 100, 50, 180, 120, 0.4F);
  CHECK(set(scene.show(depth)) == 0);
}

TEST_CASE("a hand that was there from the start moves once it has left and comes back",
          "[map][moving_mask]") {
  Scene scene(6);
  for (int i = 0; i < 10; ++i) {
    DepthImage depth = desk(scene.random);
    cover(depth, 100, 50, 180, 120, 0.4F);
    scene.show(depth);
  }
  scene.learn_desk(60);
  DepthImage depth = desk(scene.random);
  cover(depth, 100, 50, 180, 120, 0.4F);
  CHECK(set(scene.show(depth)) == 80 * 70);
}

TEST_CASE("what stays where it was put is part of the scene after a while", "[map][moving_mask]") {
  const DepthImage near(40, 24, 0.5F), far(40, 24, 1.0F);
  const PinholeCamera rays{40, 24, 21, 21, 19.5, 11.5};
  FreeSpaceSettings settings;
  settings.frames_to_settle = 30;
  FreeSpace space(kNoise, settings);
  const Eigen::Vector3d point(0.0, 0.0, 0.5);
  for (int i = 0; i < 40; ++i) space.add(rays, Rigid3::Identity(), far);
  CHECK(space.is_free(point));
  for (int i = 0; i < 29; ++i) space.add(rays, Rigid3::Identity(), near);
  CHECK(space.is_free(point));
  // Each frame follows only some of the rays, so it takes longer if only one ends in the cell.
  for (int i = 0; i < 91; ++i) space.add(rays, Rigid3::Identity(), near);
  CHECK_FALSE(space.is_free(point));
}

TEST_CASE("the margin before a surface is not free, and grows with the depth's noise",
          "[map][free_space]") {
  const PinholeCamera rays{40, 24, 21, 21, 19.5, 11.5};
  const auto free_before = [&](const DepthNoise& noise) {
    FreeSpace space(noise);
    for (int i = 0; i < 40; ++i) { space.add(rays, Rigid3::Identity(), DepthImage(40, 24, 1.0F)); }
    double last = 0;
    for (double Z = 0.1; Z < 1.1; Z += 0.005) {
      if (space.is_free({0, 0, Z})) last = Z;
    }
    return last;
  };
  const double cell = FreeSpaceSettings{}.cell;
  const double exact = free_before({}), noisy = free_before({0.05, 0, 0});
  CHECK(std::abs(exact - (1 - 0.08)) <= test::tolerance(cell, "a cell"));
  CHECK(std::abs(noisy - (1 - 4 * 0.05)) <= test::tolerance(cell, "a cell"));
}

TEST_CASE("free space keeps to its cap and survives any pose", "[map][free_space]") {
  const PinholeCamera rays{40, 24, 21, 21, 19.5, 11.5};
  FreeSpaceSettings settings;
  settings.blocks = 20;
  FreeSpace space(kNoise, settings);
  for (int i = 0; i < 40; ++i) space.add(rays, Rigid3::Identity(), DepthImage(40, 24, 2.0F));
  CHECK(space.blocks() == 20);
  CHECK(space.blocked() > 0);
  Rigid3 lost = Rigid3::Identity();
  lost.translation().x() = std::nan("");
  space.add(rays, lost, DepthImage(40, 24, 2.0F));
  lost.translation().x() = 1e9;
  space.add(rays, lost, DepthImage(40, 24, 2.0F));
  CHECK_FALSE(space.is_free(lost.translation()));
}

// The number of allocations while the mask of the frame in `scene.seen` is computed. Otherwise like
// show().
int memory_taken(Scene& scene, const Rigid3& pose, const MaskImage*& mask) {
  const int taken = test::allocations_during([&] {
    mask = &scene.mover.find(scene.seen, pose, &scene.map);
    scene.mover.learn(pose);
  });
  if (scene.frame++ % 3 == 0) scene.map.fuse(scene.seen.depth, kCamera, pose, *mask);
  return taken;
}

TEST_CASE("after the first frame the mask takes no memory, with or without a sure picture",
          "[map][moving_mask]") {
  Scene scene(7);
  const MaskImage* mask = nullptr;
  for (int i = 0; i < 46; ++i) {
    const bool with_hand = i >= 40;  // alternately with and without depth
    paint(scene.seen, scene.random, 100, 48, with_hand ? 180 : 100, 120);
    scene.seen.depth = desk(scene.random);
    if (with_hand) cover(scene.seen.depth, 100, 48, 180, 120, i % 2 == 0 ? kNaN : 0.4F);
    const int taken = memory_taken(scene, Rigid3::Identity(), mask);
    if (i > 0) CHECK(taken == 0);
    if (with_hand) CHECK(set(*mask) >= 80 * 72);
  }
}

TEST_CASE("the mask of a camera that sways takes no memory either", "[map][moving_mask]") {
  Scene scene(13);
  const MaskImage* mask = nullptr;
  for (int i = 0; i < 99; ++i) {
    const Rigid3 pose = swaying_pose(i);
    paint_wall(scene, pose.translation().x(), i >= 90);
    const int taken = memory_taken(scene, pose, mask);
    if (i > 0) CHECK(taken == 0);
    if (i >= 93) CHECK(set(*mask) > 80 * 60);  // it has no depth: the canvas is drawn
  }
}

TEST_CASE("garbage for depth gives a mask of its size", "[map][moving_mask]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    auto random = test::random_case(seed);
    std::uniform_real_distribution<float> any(-5, 5);
    Scene scene(seed);
    for (int i = 0; i < 10; ++i) {
      DepthImage depth(kCamera.width, kCamera.height);
      for (float& Z : depth) {
        Z = any(random);
        if (Z < -4) Z = kNaN;
        if (Z > 4.9F) Z = std::numeric_limits<float>::infinity();
      }
      const MaskImage& mask = scene.show(depth);
      REQUIRE(mask.width() == kCamera.width);
      for (const std::uint8_t value : mask) REQUIRE((value == 0 || value == 255));
    }
  }
}

}  // namespace
}  // namespace palpable
