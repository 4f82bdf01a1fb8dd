#include "palpable/desk/film/desk_scene.h"

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/film/painted_shapes.h"
#include "palpable/desk/film/texture_images.h"
#include "palpable/desk/script/random.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace palpable {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A book with its spine at the front. @param image  index of a book_image()
PaintedMesh book(const Vector3d& centre, const Vector3d& size, double yaw, int image) {
  // Spine and pages are upright strips in the image but horizontal on the book, so their image
  // coordinates are rotated by 90 degrees.
  PaintedMesh mesh = painted_box(centre, size, yaw,
                                 {{0.0, 0.0, 0.7, 1.0},
                                  {0.70, 0.0, 0.85, 1.0},
                                  {0.85, 0.0, 1.0, 1.0},
                                  {0.85, 0.0, 1.0, 0.8},
                                  {0.85, 0.0, 1.0, 0.8}},
                                 image);
  for (std::size_t face = 1; face < 5; ++face) {  // shift the image coordinates by one corner
    const std::array<Eigen::Vector2f, 4> uv = {
        mesh.vertices[4 * face + 0].uv, mesh.vertices[4 * face + 1].uv,
        mesh.vertices[4 * face + 2].uv, mesh.vertices[4 * face + 3].uv};
    for (std::size_t i = 0; i < 4; ++i) mesh.vertices[4 * face + i].uv = uv[(i + 1) % 4];
  }
  mesh.gloss = 0.05F;
  mesh.sharpness = 12.0F;
  return mesh;
}

/// The handle of a mug: a circle swept along half an ellipse, from the wall at radius r.
void add_handle(PaintedMesh& mesh, const Vector3d& base, double r, double handle_turn) {
  const Vector3d out(std::cos(handle_turn), std::sin(handle_turn), 0.0);
  const Vector3d side = Vector3d::UnitZ().cross(out);
  constexpr std::uint32_t kAlong = 28;
  constexpr std::uint32_t kRound = 16;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t i = 0; i <= kAlong; ++i) {
    const double t = -0.5 * std::numbers::pi + std::numbers::pi * i / kAlong;
    const Vector3d direction = std::cos(t) * out + std::sin(t) * Vector3d::UnitZ();
    const Vector3d middle = base + (r - 0.003) * out + 0.050 * Vector3d::UnitZ() +
                            0.030 * std::cos(t) * out + 0.026 * std::sin(t) * Vector3d::UnitZ();
    for (std::uint32_t k = 0; k <= kRound; ++k) {
      const double w = kTurn * k / kRound;
      const Vector3d normal = std::cos(w) * direction + std::sin(w) * side;
      mesh.vertices.push_back({(middle + 0.0055 * normal).cast<float>(),
                               normal.cast<float>(),
                               Eigen::Vector2f(static_cast<float>(k) / 48.0F,
                                               0.68F + 0.03F * static_cast<float>(i) / kAlong),
                               {1, 0, 9, 9}});
    }
  }
  for (std::uint32_t i = 0; i < kAlong; ++i)
    for (std::uint32_t k = 0; k < kRound; ++k) {
      const std::uint32_t a = first + i * (kRound + 1) + k;
      const std::uint32_t b = a + kRound + 1;
      for (const std::uint32_t v : {a, a + 1, b + 1, a, b + 1, b}) mesh.indices.push_back(v);
    }
}

PaintedMesh mug(const Vector3d& base, double handle_turn, int image) {
  PaintedMesh mesh;
  mesh.image = image;
  mesh.gloss = 0.55F;
  mesh.sharpness = 60.0F;
  const double r = 0.040;
  const double h = 0.092;
  add_turned(
      mesh, base,
      {{r - 0.006, 0.0}, {r - 0.002, 0.003}, {r, 0.010}, {r, 0.04}, {r, 0.07}, {r, h - 0.002}}, 1.0,
      0.0);
  add_turned(mesh, base, {{r, h - 0.002}, {r - 0.0015, h}, {r - 0.003, h - 0.002}}, 0.05, 0.01);
  add_turned(mesh, base, {{r - 0.003, h - 0.002}, {r - 0.0035, 0.062}}, 0.02, 0.16);
  // Coffee: a disc below the rim, with image coordinates in the dark band.
  add_turned(mesh, base, {{r - 0.0035, 0.062}, {0.0001, 0.0621}}, 0.20, 0.25);
  add_handle(mesh, base, r, handle_turn);
  return mesh;
}

enum SceneImage : int { kWood, kWall, kPage, kRed, kBlue, kGreen, kCarton, kGlaze, kFloor, kDoor };

/// Adds all things that lie on the desk.
void put_things_on_desk(DeskScene& scene, Random& random, bool left_free) {
  // The order of the random numbers, yaw, then y, then x, must not change: it determines the films
  // (random.h).
  const auto jitter = [&](double x, double y, double z) {
    const double aside_y = random.between(-0.01, 0.01);
    const double aside_x = random.between(-0.01, 0.01);
    return Vector3d(x + aside_x, y + aside_y, z);
  };
  const auto degrees = [&](double middle, double spread) {
    return (middle + random.between(-spread, spread)) * std::numbers::pi / 180.0;
  };
  const auto placed_book = [&](const Vector3d& at, const Vector3d& size, double middle,
                               double spread, int image) {
    const double yaw = degrees(middle, spread);
    return book(jitter(at.x(), at.y(), at.z()), size, yaw, image);
  };
  // The pile and the mug draw their random numbers even when they are left out, so that the other
  // things have the same positions in both cases.
  std::vector<PaintedMesh> left;
  // At the left, behind: a pile of books.
  left.push_back(placed_book({-0.27, 0.26, 0.0}, {0.23, 0.165, 0.032}, 14, 4, kBlue));
  left.push_back(placed_book({-0.26, 0.26, 0.032}, {0.21, 0.150, 0.024}, 4, 5, kRed));
  left.push_back(placed_book({-0.27, 0.255, 0.056}, {0.18, 0.125, 0.019}, 22, 5, kGreen));
  // Behind: a carton, and further right a book, behind the side from which the arm comes.
  const double carton_yaw = degrees(-12, 5);
  scene.meshes.push_back(painted_box(jitter(0.06, 0.44, 0.0), {0.155, 0.085, 0.135}, carton_yaw,
                                     {{0.0, 0.86, 1.0, 1.0},
                                      {0.0, 0.0, 1.0, 0.86},
                                      {0.0, 0.0, 1.0, 0.86},
                                      {0.2, 0.0, 0.75, 0.86},
                                      {0.2, 0.0, 0.75, 0.86}},
                                     kCarton));
  scene.meshes.push_back(placed_book({0.36, 0.47, 0.0}, {0.22, 0.16, 0.038}, -24, 4, kGreen));
  const double handle_turn = degrees(200, 15);
  left.push_back(mug(jitter(-0.215, 0.055, 0.0), handle_turn, kGlaze));
  if (!left_free) scene.meshes.insert(scene.meshes.end(), left.begin(), left.end());
  // A written page, 0.8 mm thick so that it is not coplanar with the desk.
  const double page_yaw = degrees(17, 6);
  scene.meshes.push_back(painted_box(
      jitter(-0.22, -0.13, 0.0), {0.148, 0.21, 0.0008}, page_yaw,
      {{0, 0, 1, 1}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}}, kPage));
}

/// A rectangle that repeats its image u times across and v times down. No shadows fall on it.
PaintedMesh panel(const std::array<Vector3d, 4>& corners, int image, double u, double v) {
  PaintedMesh mesh;
  mesh.image = image;
  mesh.in_shadows = false;
  add_quad(mesh, corners, {0.0, 0.0}, {u, v});
  return mesh;
}

// The room, m in the desk frame: X to the right, Y away from the first camera.
constexpr double kLeft = -4.5, kRight = 4.5, kBack = -4.0, kFar = 7.0;
constexpr double kFloorZ = -0.74, kCeilingZ = 1.90;
// The corridor begins at a door in the far wall, m.
constexpr double kDoorLeft = -0.4, kDoorRight = 1.8, kDoorTop = 1.45, kEnd = 14.3;

/// The corners of an upright rectangle above the line from (x0, y0) to (x1, y1).
std::array<Vector3d, 4> upright(double x0, double y0, double x1, double y1, double z0, double z1) {
  return {Vector3d(x0, y0, z0), Vector3d(x1, y1, z0), Vector3d(x1, y1, z1), Vector3d(x0, y0, z1)};
}

/// Adds floor, ceiling and walls of room and corridor.
void build_walls(DeskScene& scene) {
  const auto wall = [&](double x0, double y0, double x1, double y1, double z0, double z1,
                        int image) {
    const double wide = std::hypot(x1 - x0, y1 - y0);
    scene.meshes.push_back(panel(upright(x0, y0, x1, y1, z0, z1), image, wide, z1 - z0));
  };
  const auto level = [&](double x0, double y0, double x1, double y1, double z, bool up, int image,
                         double tile) {
    std::array<Vector3d, 4> corners = {Vector3d(x0, y0, z), Vector3d(x1, y0, z),
                                       Vector3d(x1, y1, z), Vector3d(x0, y1, z)};
    if (!up) std::swap(corners[1], corners[3]);
    scene.meshes.push_back(panel(corners, image, (x1 - x0) / tile, (y1 - y0) / tile));
  };
  level(kLeft, kBack, kRight, kEnd, kFloorZ, true, kFloor, 1.7);
  level(kLeft, kBack, kRight, kEnd, kCeilingZ, false, kWall, 1.0);
  wall(kLeft, kBack, kLeft, kFar, kFloorZ, kCeilingZ, kWall);
  wall(kRight, kFar, kRight, kBack, kFloorZ, kCeilingZ, kWall);
  wall(kRight, kBack, kLeft, kBack, kFloorZ, kCeilingZ, kWall);
  wall(kLeft, kFar, kDoorLeft, kFar, kFloorZ, kCeilingZ, kWall);
  wall(kDoorRight, kFar, kRight, kFar, kFloorZ, kCeilingZ, kWall);
  wall(kDoorLeft, kFar, kDoorRight, kFar, kDoorTop, kCeilingZ, kWall);
  wall(kDoorLeft, kFar, kDoorLeft, kEnd, kFloorZ, kCeilingZ, kWall);
  wall(kDoorRight, kEnd, kDoorRight, kFar, kFloorZ, kCeilingZ, kWall);
  wall(kDoorLeft, kEnd, kDoorRight, kEnd, kFloorZ, kCeilingZ, kWall);
}

/// Adds pictures and notices, 10 mm in front of the walls.
void hang_posters(DeskScene& scene) {
  const auto poster = [&](double x0, double y0, double x1, double y1, double z0, double z1,
                          int image) {
    PaintedMesh mesh = panel(upright(x0, y0, x1, y1, z0, z1), image, 1.0, 1.0);
    scene.meshes.push_back(mesh);
  };
  poster(0.15, kEnd - 0.01, 1.25, kEnd - 0.01, 0.0, 1.1, kCarton);
  poster(-3.9, kFar - 0.01, -2.7, kFar - 0.01, 0.1, 1.3, kCarton);
  poster(-2.2, kFar - 0.01, -1.4, kFar - 0.01, -0.1, 1.05, kPage);
  poster(2.2, kFar - 0.01, 3.2, kFar - 0.01, 0.1, 1.2, kRed);
  poster(kRight - 0.01, 4.6, kRight - 0.01, 3.4, 0.1, 1.2, kBlue);
  poster(kRight - 0.01, 2.3, kRight - 0.01, 1.4, 0.0, 1.2, kPage);
  poster(kRight - 0.01, 0.7, kRight - 0.01, -0.3, 0.2, 1.2, kCarton);
  poster(kLeft + 0.01, -0.5, kLeft + 0.01, 0.6, 0.0, 1.1, kGreen);
  poster(kLeft + 0.01, 1.6, kLeft + 0.01, 2.4, 0.0, 1.2, kPage);
  for (const double y : {8.6, 10.4, 12.2}) {
    poster(kDoorLeft + 0.01, y, kDoorLeft + 0.01, y + 0.9, 0.0, 1.1, kDoor);
    poster(kDoorRight - 0.01, y + 0.7, kDoorRight - 0.01, y - 0.2, 0.1, 1.0, kPage);
  }
}

/// Adds cases, shelves and boxes.
void furnish(DeskScene& scene, Random& random) {
  const auto furniture = [&](double x, double y, double z, const Vector3d& size, double yaw,
                             int image) {
    PaintedMesh mesh = painted_box(
        {x + random.between(-0.05, 0.05), y + random.between(-0.05, 0.05), z}, size, yaw,
        {{0, 0, 1, 1}, {0, 0, 1, 1}, {0, 0, 1, 1}, {0, 0, 1, 1}, {0, 0, 1, 1}}, image);
    mesh.in_shadows = false;
    scene.meshes.push_back(mesh);
  };
  furniture(-3.2, 6.5, kFloorZ, {1.6, 0.5, 0.9}, 0.0, kDoor);
  furniture(3.1, 6.4, kFloorZ, {1.4, 0.6, 0.8}, 0.0, kDoor);
  furniture(3.9, 3.8, kFloorZ, {0.6, 1.4, 0.75}, 0.05, kWood);
  furniture(3.8, 1.0, kFloorZ, {0.7, 0.9, 0.6}, -0.1, kCarton);
  furniture(3.7, 0.95, kFloorZ + 0.6, {0.4, 0.5, 0.35}, 0.3, kCarton);
  furniture(3.5, -1.2, kFloorZ, {0.6, 0.6, 0.5}, 0.4, kCarton);
  furniture(2.2, 2.6, kFloorZ, {0.45, 0.45, 0.5}, 0.5, kCarton);
  furniture(-1.6, 3.1, kFloorZ, {0.5, 0.5, 0.45}, 0.2, kCarton);
  furniture(-0.9, 4.4, kFloorZ, {0.6, 0.4, 0.7}, -0.3, kBlue);
  furniture(0.6, 3.6, kFloorZ, {0.4, 0.4, 0.4}, 0.7, kCarton);
  furniture(1.2, 5.4, kFloorZ, {0.5, 0.4, 0.6}, 0.2, kRed);
  furniture(-3.6, 1.8, kFloorZ, {0.7, 1.2, 0.8}, 0.0, kDoor);
  furniture(-2.9, 0.6, kFloorZ, {0.45, 0.5, 0.5}, 0.3, kCarton);
  furniture(0.9, 9.4, kFloorZ, {0.5, 0.4, 0.7}, 0.1, kCarton);
  furniture(0.1, 11.9, kFloorZ, {0.5, 0.4, 0.6}, 0.1, kBlue);
}

/// Adds a room of 9 x 11 m round the desk, with a corridor that extends to Y = 14.3 m.
void build_room(DeskScene& scene, Random& random, bool bare) {
  build_walls(scene);
  if (bare) return;
  hang_posters(scene);
  furnish(scene, random);
}

/// Adds the parts of the desk below its top: the edges of the board and four legs.
void carry_desk(DeskScene& scene) {
  constexpr double kThick = 0.03;
  const auto part = [&](const Vector3d& at, const Vector3d& size) {
    PaintedMesh mesh = painted_box(
        at, size, 0.0,
        {{0, 0, 1, 0.2}, {0, 0, 1, 0.2}, {0, 0, 1, 0.2}, {0, 0, 1, 0.2}, {0, 0, 1, 0.2}}, kWood);
    mesh.in_shadows = false;
    scene.meshes.push_back(mesh);
  };
  // The top of this box lies 1 mm below the desk's top, which is a mesh of its own.
  part({0.0, -0.09, -kThick}, {2.8, 1.42, kThick - 0.001});
  for (const double x : {-1.34, 1.34})
    for (const double y : {-0.74, 0.56}) part({x, y, kFloorZ}, {0.07, 0.07, -kThick - kFloorZ});
}

}  // namespace

DeskScene desk_scene(const DeskLook& look) {
  DeskScene scene;
  const std::uint64_t seed = look.seed;
  Random random(seed, "desk");
  if (look.bare) {
    const ColorImage white(8, 8, Rgb{206, 206, 202});
    scene.images.assign(10, white);
  } else {
    scene.images = {wood_image(2048, seed),
                    plaster_image(1024, seed),
                    page_image(700, 990, seed),
                    book_image(1024, {150, 52, 46}, seed + 1),
                    book_image(1024, {52, 84, 122}, seed + 2),
                    book_image(1024, {96, 112, 66}, seed + 3),
                    carton_image(1024, {214, 180, 120}, seed),
                    glaze_image(1024, seed)};
    if (look.room) {
      scene.images.push_back(tile_image(1024, seed));
      scene.images.push_back(panel_image(512, seed));
    }
  }

  // Near things are last in the list and painted first, so that pixels hidden by them are not
  // shaded.
  Random furnishing(seed, "room");
  if (look.room) build_room(scene, furnishing, look.bare);
  if (look.room) carry_desk(scene);
  PaintedMesh desk;
  desk.image = kWood;
  desk.gloss = 0.06F;
  desk.sharpness = 18.0F;
  constexpr double kWoodSize = 0.82;  // m, size of the desk that the 2048 px of the image show
  add_quad(desk,
           {Vector3d(-1.4, -0.8, 0), Vector3d(1.4, -0.8, 0), Vector3d(1.4, 0.62, 0),
            Vector3d(-1.4, 0.62, 0)},
           {0.0, 0.0}, {2.8 / kWoodSize, 1.42 / kWoodSize});
  scene.meshes.push_back(desk);
  if (!look.room) {  // the desk ends at a wall 0.62 m behind the body
    PaintedMesh wall;
    wall.image = kWall;
    add_quad(wall,
             {Vector3d(-2.5, 0.64, -0.8), Vector3d(2.5, 0.64, -0.8), Vector3d(2.5, 0.64, 1.8),
              Vector3d(-2.5, 0.64, 1.8)},
             {0.0, 0.0}, {5.0, 2.6});
    scene.meshes.push_back(wall);
  }
  if (!look.bare) put_things_on_desk(scene, random, look.left_free);
  return scene;
}

}  // namespace palpable
