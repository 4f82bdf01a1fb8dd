#include "palpable/synth/desk_scene.h"

#include "palpable/synth/random.h"
#include "palpable/synth/texture_images.h"

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

}  // namespace

DeskScene desk_scene(std::uint64_t seed) {
  DeskScene scene;
  Random random(seed, "desk");
  enum : int { kWood, kWall, kPage, kRed, kBlue, kGreen, kCarton, kGlaze };
  scene.images = {wood_image(2048, seed),
                  plaster_image(1024, seed),
                  page_image(700, 990, seed),
                  book_image(1024, {150, 52, 46}, seed + 1),
                  book_image(1024, {52, 84, 122}, seed + 2),
                  book_image(1024, {96, 112, 66}, seed + 3),
                  carton_image(1024, {214, 180, 120}, seed),
                  glaze_image(1024, seed)};

  // 2048 px of wood are 0.82 m; the desk ends 0.62 m behind the body, the wall stands there.
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
  PaintedMesh wall;
  wall.image = kWall;
  add_quad(wall,
           {Vector3d(-2.5, 0.64, -0.8), Vector3d(2.5, 0.64, -0.8), Vector3d(2.5, 0.64, 1.8),
            Vector3d(-2.5, 0.64, 1.8)},
           {0.0, 0.0}, {5.0, 2.6});
  scene.meshes.push_back(wall);

  const auto jitter = [&](double x, double y, double z) {
    return Vector3d(x + random.between(-0.01, 0.01), y + random.between(-0.01, 0.01), z);
  };
  const auto degrees = [&](double middle, double spread) {
    return (middle + random.between(-spread, spread)) * std::numbers::pi / 180.0;
  };
  // Left, behind: a pile of books.
  scene.meshes.push_back(
      book(jitter(-0.27, 0.26, 0.0), {0.23, 0.165, 0.032}, degrees(14, 4), kBlue));
  scene.meshes.push_back(
      book(jitter(-0.26, 0.26, 0.032), {0.21, 0.150, 0.024}, degrees(4, 5), kRed));
  scene.meshes.push_back(
      book(jitter(-0.27, 0.255, 0.056), {0.18, 0.125, 0.019}, degrees(22, 5), kGreen));
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
  scene.meshes.push_back(mug(jitter(-0.215, 0.055, 0.0), degrees(200, 15), kGlaze));
  // A written page, a millimetre thick so that it lies on the desk and not in it.
  PaintedMesh page = box(
      jitter(-0.22, -0.13, 0.0), {0.148, 0.21, 0.0008}, degrees(17, 6),
      {{0, 0, 1, 1}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}, {0, 0, 1, 0.01}}, kPage);
  scene.meshes.push_back(page);
  return scene;
}

std::vector<PaintedMesh> hand_meshes(std::span<const HandCapsule> hand) {
  std::vector<PaintedMesh> meshes(2);
  meshes[0].image = 0;
  meshes[0].gloss = 0.20F;
  meshes[0].sharpness = 18.0F;
  meshes[1].image = 1;
  const auto sleeve = [](const HandCapsule& c) { return c.part == HandPart::kSleeve; };

  constexpr double kTile = 0.045;        // m of skin that the image shows
  constexpr double kShadeReach = 0.014;  // m, how far ambient light is blocked by the hand itself
  constexpr double kChordError = 0.00009;
  std::uint32_t number = 0;
  for (const HandCapsule& own : hand) {
    const Capsule& c = own.shape;
    const CapsuleMesh mesh = tessellate(c, own.back, kChordError);
    PaintedMesh& out = meshes[sleeve(own) ? 1 : 0];
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    // Width of the smooth union in the shading, m: fingers keep their joints, the back of the hand
    // is one surface.
    const double blend = own.part == HandPart::kPalm ? 0.0055 : 0.0026;
    const double tile = sleeve(own) ? 0.05 : kTile;
    const double turns = std::max(1.0, std::round(kTurn * std::max(c.ra, c.rb) / tile * 2.0)) / 2.0;
    const Vector3d axis = (c.b - c.a).normalized();
    const Vector3d back = (own.back - own.back.dot(axis) * axis).normalized();
    const Vector3d side = axis.cross(back);

    // Only capsules that reach near this one matter for its shading.
    std::vector<const HandCapsule*> near;
    const Vector3d middle = 0.5 * (c.a + c.b);
    const double reach = 0.5 * (c.b - c.a).norm() + std::max(c.ra, c.rb) + 2.0 * kShadeReach;
    for (const HandCapsule& other : hand)
      if (&other != &own && signed_distance(other.shape, middle) < reach) near.push_back(&other);

    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
      const Vector3d x = mesh.vertices.col(v);
      const Vector3d n = mesh.normals.col(v);
      Vector3d smooth = n;
      double open = kShadeReach;
      bool hidden = false;
      for (const HandCapsule* other : near) {
        const double d = signed_distance(other->shape, x);
        hidden = hidden || d < -2.0 * blend;
        if (d > 2.5 * kShadeReach) continue;
        if (d < 4.0 * blend && sleeve(own) == sleeve(*other))
          smooth += std::exp(-d / blend) * distance_normal(other->shape, x);
        open = std::min(open, signed_distance(other->shape, x + kShadeReach * smooth.normalized()));
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
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
      for (int k = 0; k < 3; ++k)
        out.indices.push_back(first + static_cast<std::uint32_t>(mesh.triangles(k, t)));
    ++number;
  }
  return meshes;
}

}  // namespace palpable
