#include "palpable/live/map/scene_canvas.h"

#include "tests/support/test.h"

#include <cmath>
#include <cstdlib>

namespace palpable {
namespace {

// Wider than high, with the principal point not at a tile's border.
const PinholeCamera kCamera{160, 96, 100, 100, 81.3, 46.2};
constexpr int kTiles = 40, kRows = 24;

Rigid3 at(double x, double y, double turn = 0) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(x, y, 0);
  return pose;
}

// A picture of a wall as a smooth function of the wall's coordinates in m, so that a shift of half
// a pixel makes little difference.
double light_of(double X, double Y) { return 128 + 60 * std::sin(9 * X) + 50 * std::cos(11 * Y); }

// A wall at `wall` m; in front of it, where the frame's X < -0.2 m of it, a board at 0.5 m.
struct Room {
  void see(const Rigid3& pose, bool with_board) {
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        const Eigen::Vector3d ray = pose.linear() * kCamera.unproject(x, y, 1.0);
        const Eigen::Vector3d eye = pose.translation();
        const auto hit = [&](double Z) -> Eigen::Vector3d {
          return eye + (Z - eye.z()) / ray.z() * ray;
        };
        double Z = 1;
        if (with_board && hit(0.5).x() < -0.2) Z = 0.5;
        const Eigen::Vector3d p = hit(Z);
        const double level = Z < 1 ? 20 : light_of(p.x(), p.y());
        luma(x, y) = static_cast<std::uint8_t>(std::lround(level));
        color(x, y) = {luma(x, y), luma(x, y), luma(x, y)};
        if (x % 4 == 2 && y % 4 == 2) {
          depth(x / 4, y / 4) = static_cast<float>((pose.inverse() * p).z());
        }
      }
    }
  }
  void learn(const Rigid3& pose, int frames, bool with_board = false) {
    for (int k = 0; k < frames; ++k) {
      see(pose, with_board);
      canvas.follow(kCamera, pose);
      if (!canvas.stays()) continue;
      canvas.draw(pose, view);
      REQUIRE(picture.compare(luma, color, kCamera.width, kCamera.height, all, view));
      canvas.learn(pose, picture, depth, all, none);
    }
  }
  [[nodiscard]] int known() const {
    int count = 0;
    for (const std::uint8_t k : view.known) count += k != 0 ? 1 : 0;
    return count;
  }
  // The largest difference of view and frame in the known tiles.
  [[nodiscard]] int worst() const {
    int worst = 0;
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        if (view.known(x / 4, y / 4) == 0) continue;
        worst = std::max(worst, std::abs(int{view.luma(x, y)} - int{luma(x, y)}));
      }
    }
    return worst;
  }

  GrayImage luma{kCamera.width, kCamera.height};
  ColorImage color{kCamera.width, kCamera.height};
  DepthImage depth{kTiles, kRows};
  Image<std::uint8_t> all{kTiles, kRows, 1}, none{kTiles, kRows, 0};
  SceneCanvas canvas;
  StaticPicture picture;
  PictureView view{GrayImage(kCamera.width, kCamera.height), Image<TileColor>(kTiles, kRows),
                   Image<std::uint8_t>(kTiles, kRows), Image<std::uint8_t>(kTiles, kRows)};
};

TEST_CASE("a scene is drawn as it is seen from beside the key", "[map][scene_canvas]") {
  Room room;
  room.learn(at(0, 0), 80);
  for (const Rigid3& pose : {at(0.03, 0), at(-0.02, 0.04), at(0.01, 0.01, 0.05)}) {
    room.see(pose, false);
    room.canvas.draw(pose, room.view);
    // Parts that the key did not see are within 4 + 5 px of the border.
    CHECK(room.known() >= (kTiles - 4) * (kRows - 3));
    CHECK(room.worst() <= test::tolerance(9, "levels: 6.1 a pixel, and one of it at most"));
  }
}

TEST_CASE("the margin is learnt where the camera sways to", "[map][scene_canvas]") {
  Room room;
  room.learn(at(0, 0), 80);
  const Rigid3 aside = at(0.1, 0.05);
  room.learn(aside, 8);
  room.canvas.draw(aside, room.view);
  CHECK(room.known() >= (kTiles - 2) * (kRows - 2));
  CHECK(room.worst() <= test::tolerance(9, "levels: 6.1 a pixel, and one of it at most"));
  // It is still the same canvas.
  room.see(at(0, 0), false);
  room.canvas.draw(at(0, 0), room.view);
  CHECK(room.known() >= (kTiles - 2) * (kRows - 2));
}

TEST_CASE("what is nearer covers what is farther", "[map][scene_canvas]") {
  Room room;
  room.learn(at(0, 0), 80, true);
  const Rigid3 aside = at(-0.03, 0);  // the board moves 6 px to the right, the wall 3
  room.see(aside, true);
  room.canvas.draw(aside, room.view);
  int board = 0, wrong = 0;
  for (int y = 8; y < kCamera.height - 8; ++y) {
    for (int x = 8; x < kCamera.width; ++x) {
      if (room.luma(x, y) != 20 || room.view.known(x / 4, y / 4) == 0) continue;
      ++board;
      wrong += room.view.luma(x, y) != 20 ? 1 : 0;
    }
  }
  REQUIRE(board > 1000);
  CHECK(wrong <= test::tolerance(4, "px at the board's side, half a tile and the rounding") *
                     (kCamera.height - 16));
}

TEST_CASE("a camera that walks keeps nothing, one that has walked begins anew",
          "[map][scene_canvas]") {
  Room room;
  for (int k = 0; k < 100; ++k) {
    room.canvas.follow(kCamera, at(0.08 * k, 0));
    CHECK_FALSE(room.canvas.stays());
  }
  room.learn(at(0, 0), 80);
  CHECK(room.canvas.stays());
  room.canvas.draw(at(0, 0), room.view);
  REQUIRE(room.known() > 0);
  room.canvas.follow(kCamera, at(0.6, 0));
  CHECK_FALSE(room.canvas.stays());
  room.canvas.draw(at(0.6, 0), room.view);
  CHECK(room.known() == 0);
  Rigid3 lost = at(0, 0);
  lost.translation().x() = std::nan("");
  room.canvas.follow(kCamera, lost);
  CHECK_FALSE(room.canvas.stays());
}

}  // namespace
}  // namespace palpable
