#include "palpable/desk/film/painted_shapes.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace palpable {

using Eigen::Vector2d;
using Eigen::Vector3d;

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

PaintedMesh painted_box(const Vector3d& base, const Vector3d& size, double yaw,
                        const BoxFaces& faces, int image) {
  PaintedMesh mesh;
  mesh.image = image;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  const auto at = [&](double x, double y, double z) {
    return Vector3d(base + R * Vector3d(0.5 * x * size.x(), 0.5 * y * size.y(), z * size.z()));
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

void add_turned(PaintedMesh& mesh, const Vector3d& base, const std::vector<Vector2d>& profile,
                double v0, double v1) {
  constexpr int kAround = 72;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto rings = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t r = 0; r < rings; ++r) {
    const Vector2d along = profile[std::min(r + 1, rings - 1)] - profile[r > 0 ? r - 1 : 0];
    const Vector2d out = Vector2d(along.y(), -along.x()).normalized();
    for (int c = 0; c <= kAround; ++c) {
      const double turn = 2.0 * std::numbers::pi * c / kAround;
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

}  // namespace palpable
