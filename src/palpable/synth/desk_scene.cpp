#include "palpable/synth/desk_scene.h"

#include "palpable/base/contract.h"
#include "palpable/synth/random.h"
#include "palpable/synth/texture_images.h"
#include "palpable/synth/things.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace palpable {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;

void add_quad(PaintedMesh& mesh, const std::array<Vector3d, 4>& corners, const Vector2d& uv0,
              const Vector2d& uv1) {
  const Vector3d normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalized();
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::array<Vector2d, 4> uv = {
      {{uv0.x(), uv1.y()}, {uv1.x(), uv1.y()}, {uv1.x(), uv0.y()}, {uv0.x(), uv0.y()}}};
  for (std::size_t i = 0; i < 4; ++i)
    mesh.vertices.push_back(
        {corners[i].cast<float>(), normal.cast<float>(), uv[i].cast<float>(), {1, 0, 9, 9}});
  for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + i);
}

/// Which part of the image each face of a box shows: (u0, v0) .. (u1, v1).
struct BoxFaces {
  std::array<double, 4> top, front, back, left, right;
};

/// A box that stands on height z, turned about the vertical.
PaintedMesh box(const Vector3d& centre, const Vector3d& size, double yaw, const BoxFaces& faces,
                int image) {
  PaintedMesh mesh;
  mesh.image = image;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  const auto at = [&](double x, double y, double z) {
    return Vector3d(centre + R * Vector3d(0.5 * x * size.x(), 0.5 * y * size.y(), z * size.z()));
  };
  const auto face = [&](const std::array<Vector3d, 4>& corners, const std::array<double, 4>& part) {
    add_quad(mesh, corners, {part[0], part[1]}, {part[2], part[3]});
  };
  face({at(-1, -1, 1), at(1, -1, 1), at(1, 1, 1), at(-1, 1, 1)}, faces.top);
  face({at(-1, -1, 0), at(1, -1, 0), at(1, -1, 1), at(-1, -1, 1)}, faces.front);
  face({at(1, 1, 0), at(-1, 1, 0), at(-1, 1, 1), at(1, 1, 1)}, faces.back);
  face({at(-1, 1, 0), at(-1, -1, 0), at(-1, -1, 1), at(-1, 1, 1)}, faces.left);
  face({at(1, -1, 0), at(1, 1, 0), at(1, 1, 1), at(1, -1, 1)}, faces.right);
  return mesh;
}

/// A book lies with its spine to the front; the image's parts are those of book_image.
PaintedMesh book(const Vector3d& centre, const Vector3d& size, double yaw, int image) {
  // Spine and pages are upright strips in the image, and lie on the book: their quads are turned.
  PaintedMesh mesh = box(centre, size, yaw,
                         {{0.0, 0.0, 0.7, 1.0},
                          {0.70, 0.0, 0.85, 1.0},
                          {0.85, 0.0, 1.0, 1.0},
                          {0.85, 0.0, 1.0, 0.8},
                          {0.85, 0.0, 1.0, 0.8}},
                         image);
  for (std::size_t face = 1; face < 5; ++face) {  // the corners run the other way round the strip
    const std::array<Eigen::Vector2f, 4> uv = {
        mesh.vertices[4 * face + 0].uv, mesh.vertices[4 * face + 1].uv,
        mesh.vertices[4 * face + 2].uv, mesh.vertices[4 * face + 3].uv};
    for (std::size_t i = 0; i < 4; ++i) mesh.vertices[4 * face + i].uv = uv[(i + 1) % 4];
  }
  mesh.gloss = 0.05F;
  mesh.sharpness = 12.0F;
  return mesh;
}

/// A surface of revolution round the vertical through `base`: profile points (radius, height).
void add_turned(PaintedMesh& mesh, const Vector3d& base, const std::vector<Vector2d>& profile,
                double v0, double v1) {
  constexpr int kAround = 72;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto rings = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t r = 0; r < rings; ++r) {
    const Vector2d along = profile[std::min(r + 1, rings - 1)] - profile[r > 0 ? r - 1 : 0];
    const Vector2d out = Vector2d(along.y(), -along.x()).normalized();
    for (int c = 0; c <= kAround; ++c) {
      const double turn = kTurn * c / kAround;
      const Vector3d radial(std::cos(turn), std::sin(turn), 0.0);
      const Vector3d at = base + profile[r].x() * radial + profile[r].y() * Vector3d::UnitZ();
      const Vector3d normal = out.x() * radial + out.y() * Vector3d::UnitZ();
      const double v = v0 + (v1 - v0) * r / (rings - 1);
      mesh.vertices.push_back({at.cast<float>(),
                               normal.cast<float>(),
                               Vector2d(static_cast<double>(c) / kAround, v).cast<float>(),
                               {1, 0, 9, 9}});
    }
  }
  for (std::uint32_t r = 0; r + 1 < rings; ++r)
    for (std::uint32_t c = 0; c < kAround; ++c) {
      const std::uint32_t i = first + r * (kAround + 1) + c;
      for (const std::uint32_t k : {i, i + 1, i + kAround + 2, i, i + kAround + 2, i + kAround + 1})
        mesh.indices.push_back(k);
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
  // Coffee: a disc below the rim; its image coordinates stay in the dark band.
  add_turned(mesh, base, {{r - 0.0035, 0.062}, {0.0001, 0.0621}}, 0.20, 0.25);
  // The handle: a swept circle.
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
  return mesh;
}

enum SceneImage : int { kWood, kWall, kPage, kRed, kBlue, kGreen, kCarton, kGlaze, kFloor, kDoor };

/// All that lies on the desk.
void put_things_on_desk(DeskScene& scene, Random& random, bool left_free) {
  const auto jitter = [&](double x, double y, double z) {
    return Vector3d(x + random.between(-0.01, 0.01), y + random.between(-0.01, 0.01), z);
  };
  const auto degrees = [&](double middle, double spread) {
    return (middle + random.between(-spread, spread)) * std::numbers::pi / 180.0;
  };
  // The pile and the mug are placed even where they stay away, so that the rest lies where it does.
  std::vector<PaintedMesh> left;
  // Left, behind: a pile of books.
  left.push_back(book(jitter(-0.27, 0.26, 0.0), {0.23, 0.165, 0.032}, degrees(14, 4), kBlue));
  left.push_back(book(jitter(-0.26, 0.26, 0.032), {0.21, 0.150, 0.024}, degrees(4, 5), kRed));
  left.push_back(book(jitter(-0.27, 0.255, 0.056), {0.18, 0.125, 0.019}, degrees(22, 5), kGreen));
  // Behind, a carton; further right another book, standing behind where the arm comes from.
  PaintedMesh carton = box(jitter(0.06, 0.44, 0.0), {0.155, 0.085, 0.135}, degrees(-12, 5),
                           {{0.0, 0.86, 1.0, 1.0},
                            {0.0, 0.0, 1.0, 0.86},
                            {0.0, 0.0, 1.0, 0.86},
                            {0.2, 0.0, 0.75, 0.86},
                            {0.2, 0.0, 0.75, 0.86}},
                           kCarton);
  scene.meshes.push_back(carton);
  scene.meshes.push_back(
      book(jitter(0.36, 0.47, 0.0), {0.22, 0.16, 0.038}, degrees(-24, 4), kGreen));
  left.push_back(mug(jitter(-0.215, 0.055, 0.0), degrees(200, 15), kGlaze));
  if (!left_free) scene.meshes.insert(scene.meshes.end(), left.begin(), left.end());
  // A written page, a millimetre thick so that it lies on the desk and not in it.
  PaintedMesh page = box(
      jitter(-0.22, -0.13, 0.0), {0.148, 0.21, 0.0008}, degrees(17, 6),
      {{0, 0, 1, 1}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}}, kPage);
  scene.meshes.push_back(page);
}

/// A rectangle that shows its image so many times.
PaintedMesh panel(const std::array<Vector3d, 4>& corners, int image, double u, double v) {
  PaintedMesh mesh;
  mesh.image = image;
  mesh.in_shadows = false;
  add_quad(mesh, corners, {0.0, 0.0}, {u, v});
  return mesh;
}

constexpr double kFloorZ = -0.74;  // m, seen from the desk
constexpr double kCeilingZ = 1.90;

/// A room of 9 x 11 m round the desk; a corridor leads out of its far wall to 15 m.
void build_room(DeskScene& scene, Random& random, bool bare) {
  const double left = -4.5, right = 4.5, back = -4.0, far = 7.0;
  const double door_left = -0.4, door_right = 1.8, door_top = 1.45, end = 14.3;
  const auto upright = [](double x0, double y0, double x1, double y1, double z0, double z1) {
    return std::array<Vector3d, 4>{Vector3d(x0, y0, z0), Vector3d(x1, y1, z0), Vector3d(x1, y1, z1),
                                   Vector3d(x0, y0, z1)};
  };
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
  level(left, back, right, end, kFloorZ, true, kFloor, 1.7);
  level(left, back, right, end, kCeilingZ, false, kWall, 1.0);
  wall(left, back, left, far, kFloorZ, kCeilingZ, kWall);
  wall(right, far, right, back, kFloorZ, kCeilingZ, kWall);
  wall(right, back, left, back, kFloorZ, kCeilingZ, kWall);
  wall(left, far, door_left, far, kFloorZ, kCeilingZ, kWall);
  wall(door_right, far, right, far, kFloorZ, kCeilingZ, kWall);
  wall(door_left, far, door_right, far, door_top, kCeilingZ, kWall);
  wall(door_left, far, door_left, end, kFloorZ, kCeilingZ, kWall);
  wall(door_right, end, door_right, far, kFloorZ, kCeilingZ, kWall);
  wall(door_left, end, door_right, end, kFloorZ, kCeilingZ, kWall);
  if (bare) return;

  // Pictures and notices, a hand's breadth before the plaster that they hang on.
  const auto poster = [&](double x0, double y0, double x1, double y1, double z0, double z1,
                          int image) {
    PaintedMesh mesh = panel(upright(x0, y0, x1, y1, z0, z1), image, 1.0, 1.0);
    scene.meshes.push_back(mesh);
  };
  poster(0.15, end - 0.01, 1.25, end - 0.01, 0.0, 1.1, kCarton);
  poster(-3.9, far - 0.01, -2.7, far - 0.01, 0.1, 1.3, kCarton);
  poster(-2.2, far - 0.01, -1.4, far - 0.01, -0.1, 1.05, kPage);
  poster(2.2, far - 0.01, 3.2, far - 0.01, 0.1, 1.2, kRed);
  poster(right - 0.01, 4.6, right - 0.01, 3.4, 0.1, 1.2, kBlue);
  poster(right - 0.01, 2.3, right - 0.01, 1.4, 0.0, 1.2, kPage);
  poster(right - 0.01, 0.7, right - 0.01, -0.3, 0.2, 1.2, kCarton);
  poster(left + 0.01, -0.5, left + 0.01, 0.6, 0.0, 1.1, kGreen);
  poster(left + 0.01, 1.6, left + 0.01, 2.4, 0.0, 1.2, kPage);
  for (const double y : {8.6, 10.4, 12.2}) {
    poster(door_left + 0.01, y, door_left + 0.01, y + 0.9, 0.0, 1.1, kDoor);
    poster(door_right - 0.01, y + 0.7, door_right - 0.01, y - 0.2, 0.1, 1.0, kPage);
  }

  // Furniture: cases, shelves and boxes between 1.5 and 7 m away.
  const auto furniture = [&](double x, double y, double z, const Vector3d& size, double yaw,
                             int image) {
    PaintedMesh mesh =
        box({x + random.between(-0.05, 0.05), y + random.between(-0.05, 0.05), z}, size, yaw,
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

/// Below the top: its edges and four legs.
void carry_desk(DeskScene& scene) {
  constexpr double kThick = 0.03;
  const auto part = [&](const Vector3d& at, const Vector3d& size) {
    PaintedMesh mesh = box(
        at, size, 0.0,
        {{0, 0, 1, 0.2}, {0, 0, 1, 0.2}, {0, 0, 1, 0.2}, {0, 0, 1, 0.2}, {0, 0, 1, 0.2}}, kWood);
    mesh.in_shadows = false;
    scene.meshes.push_back(mesh);
  };
  // The board's own top is the desk; it lies a millimetre lower.
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

  // 2048 px of wood are 0.82 m. Near things are last: what they hide is not shaded.
  Random furnishing(seed, "room");
  if (look.room) build_room(scene, furnishing, look.bare);
  if (look.room) carry_desk(scene);
  PaintedMesh desk;
  desk.image = kWood;
  desk.gloss = 0.06F;
  desk.sharpness = 18.0F;
  constexpr double kWoodSize = 0.82;
  add_quad(desk,
           {Vector3d(-1.4, -0.8, 0), Vector3d(1.4, -0.8, 0), Vector3d(1.4, 0.62, 0),
            Vector3d(-1.4, 0.62, 0)},
           {0.0, 0.0}, {2.8 / kWoodSize, 1.42 / kWoodSize});
  scene.meshes.push_back(desk);
  if (!look.room) {  // the desk ends 0.62 m behind the body, a wall stands there
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

namespace {

/// The cup as one piece: outside, rounded rim, inside, floor, handle; in its own frame.
PaintedMesh cup_mesh() {
  PaintedMesh mesh;
  mesh.gloss = 0.45F;
  mesh.sharpness = 50.0F;
  const double R = kCupRadius;
  const double h = kCupHeight;
  const double r = kCupWallRadius;
  const Vector3d base = Vector3d::Zero();
  std::vector<Vector2d> rim;  // half a circle over the wall
  for (int i = 0; i <= 8; ++i) {
    const double t = std::numbers::pi * i / 8.0;
    rim.emplace_back(R - r + r * std::cos(t), h - r + r * std::sin(t));
  }
  std::vector<Vector2d> foot;
  for (int i = 0; i <= 4; ++i) {
    const double t = 0.5 * std::numbers::pi * (i / 4.0 - 1.0);
    foot.emplace_back(R - r + r * std::cos(t), r + r * std::sin(t));
  }
  add_turned(mesh, base, {{0.0001, 0.0}, foot.front()}, 0.99, 0.98);
  add_turned(mesh, base, foot, 0.98, 0.96);
  add_turned(mesh, base, {foot.back(), {R, 0.03}, {R, 0.06}, rim.front()}, 0.96, 0.06);
  add_turned(mesh, base, rim, 0.06, 0.02);
  add_turned(mesh, base, {rim.back(), {R - 2 * r, 0.006}}, 0.02, 0.14);
  add_turned(mesh, base, {{R - 2 * r, 0.006}, {0.0001, 0.006}}, 0.14, 0.16);
  return mesh;
}

void move(PaintedMesh& mesh, const Rigid3& transform) {
  const Eigen::Isometry3f T = transform.cast<float>();
  for (PaintedVertex& v : mesh.vertices) {
    v.position = T * v.position;
    v.normal = T.linear() * v.normal;
  }
}

enum MoverImage : int { kSkin, kCloth, kPaint, kRawWood, kLead, kCupGlaze, kMoverImages };

MoverImage image_of(HandPart part) {
  switch (part) {
    case HandPart::kSleeve:
      return kCloth;
    case HandPart::kPencil:
      return kPaint;
    case HandPart::kPencilWood:
      return kRawWood;
    case HandPart::kPencilLead:
      return kLead;
    case HandPart::kCup:
      return kCupGlaze;
    case HandPart::kPalm:
    case HandPart::kBone:
    case HandPart::kFingerTip:
    case HandPart::kForearm:
      break;
  }
  return kSkin;
}

bool is_held(const HandCapsule& c) { return image_of(c.part) >= kPaint; }

constexpr double kChordError = 0.00009;  // m, of a mover's triangles

/// What of a hand reaches near one capsule (m), itself left out.
std::vector<const HandCapsule*> near_to(const Capsule& own, double reach,
                                        std::span<const HandCapsule> capsules) {
  std::vector<const HandCapsule*> near;
  const Vector3d middle = 0.5 * (own.a + own.b);
  const double within = 0.5 * (own.b - own.a).norm() + std::max(own.ra, own.rb) + reach;
  for (const HandCapsule& other : capsules)
    if (!is_held(other) && (other.shape.a != own.a || other.shape.b != own.b) &&
        signed_distance(other.shape, middle) < within)
      near.push_back(&other);
  return near;
}

/// Signed distances of a capsule's vertices (columns) to others (rows), m.
std::vector<CapsuleField> fields_of(const std::vector<const HandCapsule*>& capsules) {
  std::vector<CapsuleField> fields;
  fields.reserve(capsules.size());
  for (const HandCapsule* capsule : capsules) fields.emplace_back(capsule->shape);
  return fields;
}
Eigen::MatrixXd distances_of(const CapsuleMesh& mesh, std::span<const CapsuleField> others) {
  Eigen::MatrixXd distances(static_cast<Eigen::Index>(others.size()), mesh.vertices.cols());
  for (Eigen::Index v = 0; v < distances.cols(); ++v) {
    const Vector3d x = mesh.vertices.col(v);
    for (std::size_t k = 0; k < others.size(); ++k)
      distances(static_cast<Eigen::Index>(k), v) = others[k].distance(x);
  }
  return distances;
}

/// Whether a triangle lies inside one other capsule, deeper than that one's own triangles do.
/// Capsules are convex: its corners decide.
bool is_hidden(const Eigen::Vector3i& triangle, const Eigen::MatrixXd& distances) {
  for (Eigen::Index k = 0; k < distances.rows(); ++k) {
    const double farthest_out =
        std::max({distances(k, triangle[0]), distances(k, triangle[1]), distances(k, triangle[2])});
    if (farthest_out < -1.5 * kChordError) return true;
  }
  return false;
}

}  // namespace

std::vector<ColorImage> mover_images(const DeskLook& look) {
  return {skin_image(512, look.skin_texture, look.seed),
          cloth_image(256, look.seed),
          pencil_image(256, look.seed),
          ColorImage(8, 8, Rgb{222, 184, 138}),
          ColorImage(8, 8, Rgb{58, 58, 62}),
          glaze_image(1024, look.seed + 1)};
}

std::vector<PaintedMesh> mover_meshes(std::span<const HandCapsule> capsules,
                                      const std::optional<Rigid3>& desk_from_cup,
                                      const DeskLook& look, std::span<const HandCapsule> also) {
  PALPABLE_EXPECT(also.empty() || also.size() == capsules.size(), "it is the same at both moments");
  std::vector<PaintedMesh> meshes(kMoverImages);
  for (int i = 0; i < kMoverImages; ++i) meshes[static_cast<std::size_t>(i)].image = i;
  meshes[kSkin].gloss = static_cast<float>(look.skin_gloss);
  meshes[kSkin].sharpness = 18.0F;
  meshes[kPaint].gloss = 0.35F;
  meshes[kPaint].sharpness = 40.0F;
  if (desk_from_cup) {
    static const PaintedMesh kCup = cup_mesh();
    PaintedMesh cup = kCup;
    move(cup, *desk_from_cup);
    cup.image = kCupGlaze;
    meshes[kCupGlaze] = std::move(cup);
  }
  const auto sleeve = [](const HandCapsule& c) { return c.part == HandPart::kSleeve; };

  constexpr double kTile = 0.045;        // m of skin that the image shows
  constexpr double kShadeReach = 0.014;  // m, how far ambient light is blocked by the hand itself
  std::uint32_t number = 0;
  std::vector<const HandCapsule*> drawn;
  const std::size_t staves = static_cast<std::size_t>(kCupStaves);
  std::size_t of_cup = 0;
  for (const HandCapsule& c : capsules) {
    // The wall is drawn as one piece; the handle as it is.
    if (c.part == HandPart::kCup && desk_from_cup && of_cup++ % (staves + kCupHandleParts) < staves)
      continue;
    drawn.push_back(&c);
  }
  for (const HandCapsule* one : drawn) {
    const HandCapsule& own = *one;
    const Capsule& c = own.shape;
    const CapsuleMesh mesh = tessellate(c, own.back, kChordError);
    PaintedMesh& out = meshes[image_of(own.part)];
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    // Width of the smooth union in the shading, m: fingers keep their joints, the back of the hand
    // is one surface.
    const double blend = own.part == HandPart::kPalm ? 0.0055 : 0.0026;
    const double tile = sleeve(own) || own.part == HandPart::kPencil ? 0.05 : kTile;
    const double turns =
        own.part == HandPart::kPencil
            ? 1.0
            : std::max(1.0, std::round(kTurn * std::max(c.ra, c.rb) / tile * 2.0)) / 2.0;
    const Vector3d axis = (c.b - c.a).normalized();
    const Vector3d back = (own.back - own.back.dot(axis) * axis).normalized();
    const Vector3d side = axis.cross(back);

    const std::vector<const HandCapsule*> near = near_to(c, 2.0 * kShadeReach, capsules);
    const std::vector<CapsuleField> fields = fields_of(near);
    const Eigen::MatrixXd distances = distances_of(mesh, fields);
    // Triangles that nobody sees are left out, and their corners are not shaded.
    std::vector<bool> is_seen(static_cast<std::size_t>(mesh.vertices.cols()), false);
    Eigen::MatrixXd also_distances;
    if (!also.empty()) {
      const HandCapsule& then = also[static_cast<std::size_t>(one - capsules.data())];
      const CapsuleMesh moved = tessellate(then.shape, then.back, kChordError);
      PALPABLE_EXPECT(moved.triangles == mesh.triangles, "what moves keeps its triangles");
      also_distances = distances_of(moved, fields_of(near_to(then.shape, 0.0, also)));
    }
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const Eigen::Vector3i triangle = mesh.triangles.col(t);
      if (is_hidden(triangle, distances) && (also.empty() || is_hidden(triangle, also_distances)))
        continue;
      for (const int corner : triangle) {
        is_seen[static_cast<std::size_t>(corner)] = true;
        out.indices.push_back(first + static_cast<std::uint32_t>(corner));
      }
    }

    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
      const Vector3d x = mesh.vertices.col(v);
      const Vector3d n = mesh.normals.col(v);
      if (!is_seen[static_cast<std::size_t>(v)]) {
        out.vertices.push_back({x.cast<float>(), n.cast<float>(), Eigen::Vector2f::Zero()});
        continue;
      }
      Vector3d smooth = n;
      double open = kShadeReach;
      bool hidden = false;
      for (std::size_t k = 0; k < near.size() && !is_held(own); ++k) {
        const double d = distances(static_cast<Eigen::Index>(k), v);
        hidden = hidden || d < -2.0 * blend;
        if (d > 2.5 * kShadeReach) continue;
        if (d < 4.0 * blend && sleeve(own) == sleeve(*near[k]))
          smooth += std::exp(-d / blend) * fields[k].normal(x);
        // A point kShadeReach away is at most so much nearer.
        if (d - kShadeReach < open)
          open = std::min(open, fields[k].distance(x + kShadeReach * smooth.normalized()));
      }
      if (hidden) smooth = n;
      PaintedVertex vertex;
      vertex.position = x.cast<float>();
      vertex.normal = smooth.normalized().cast<float>();
      const double arc = mesh.where(0, v);
      vertex.uv =
          Eigen::Vector2f(static_cast<float>(arc / tile + 0.37 * number),
                          static_cast<float>(mesh.where(1, v) / kTurn * turns + 0.61 * number));
      vertex.extra.x() = static_cast<float>(0.35 + 0.65 * std::clamp(open / kShadeReach, 0.0, 1.0));
      if (own.part == HandPart::kFingerTip && n.dot(back) > 0.0) {
        const Vector3d local = x - c.b;
        vertex.extra.z() = static_cast<float>((local.dot(axis) + 0.10 * c.rb) / (0.86 * c.rb));
        vertex.extra.w() = static_cast<float>(local.dot(side) / (0.74 * c.rb));
      }
      // Creases: rings round the back of the finger at its joints.
      if (own.part == HandPart::kBone || own.part == HandPart::kFingerTip) {
        const double from_joint = std::abs((x - c.a).dot(axis)) / 0.0042;
        if (n.dot(back) > -0.3)
          vertex.extra.y() = static_cast<float>(std::exp(-from_joint * from_joint));
      }
      out.vertices.push_back(vertex);
    }
    ++number;
  }
  return meshes;
}

}  // namespace palpable
