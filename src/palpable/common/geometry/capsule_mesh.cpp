#include "palpable/common/geometry/capsule_mesh.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpable {

namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// The axis of a capsule, two directions perpendicular to it, and the inclination of its side.
struct CapsuleAxes {
  Vector3d axis, e1, e2;
  double length;
  double
      tilt;  // rad, of the normals of the conical side out of the plane perpendicular to the axis
};

CapsuleAxes axes_of(const Capsule& capsule, const Vector3d& side) {
  CapsuleAxes frame;
  const Vector3d ab = capsule.b - capsule.a;
  frame.length = ab.norm();
  const bool has_axis = frame.length > 0.0;
  // If one sphere contains the other, there is no conical side; clamping keeps the asin defined.
  frame.tilt = has_axis ? std::asin(std::clamp((capsule.ra - capsule.rb) / frame.length, -1.0, 1.0))
                        : 0.5 * pi;
  frame.axis = has_axis ? Vector3d(ab / frame.length) : Vector3d::UnitZ();
  const Vector3d across = side - side.dot(frame.axis) * frame.axis;
  const double width = across.norm();
  frame.e1 = width > 1e-12 ? Vector3d(across / width) : frame.axis.unitOrthogonal();
  frame.e2 = frame.axis.cross(frame.e1);
  return frame;
}

/// The vertices on one circle of latitude of the sphere at a or at b.
struct Ring {
  double angle;  // rad, of the normals out of the plane perpendicular to the axis
  bool at_b;
};

/// The rings from the pole at a to the pole at b. The conical side lies between the last ring of a
/// and the first of b.
/// @param step  rad, largest angle between neighbouring rings of a sphere
std::vector<Ring> rings_of(double tilt, double step) {
  const auto arcs = [&](double angle) {
    return std::max(1, static_cast<int>(std::ceil(angle / step)));
  };
  const int arcs_a = arcs(tilt + 0.5 * pi);
  const int arcs_b = arcs(0.5 * pi - tilt);
  std::vector<Ring> rings;
  for (int i = 0; i <= arcs_a; ++i)
    rings.push_back({-0.5 * pi + (tilt + 0.5 * pi) * i / arcs_a, false});
  for (int i = 0; i <= arcs_b; ++i) rings.push_back({tilt + (0.5 * pi - tilt) * i / arcs_b, true});
  return rings;
}

/// The triangles between neighbouring rings, which have around + 1 vertices each.
Eigen::Matrix3Xi triangles_between(int rings, int around) {
  const int columns = around + 1;
  Eigen::Matrix3Xi triangles(3, 2 * (rings - 1) * around);
  int t = 0;
  for (int r = 0; r + 1 < rings; ++r)
    for (int c = 0; c < around; ++c) {
      const int i = r * columns + c;
      triangles.col(t++) << i, i + 1, i + columns + 1;
      triangles.col(t++) << i, i + columns + 1, i + columns;
    }
  return triangles;
}

}  // namespace

CapsuleMesh tessellate(const Capsule& capsule, const Vector3d& side, double chord_error) {
  PALPABLE_EXPECT(capsule.ra > 0.0 && capsule.rb > 0.0 && chord_error > 0.0,
                  "radii and the chord error are positive");
  const CapsuleAxes frame = axes_of(capsule, side);
  const double tilt = frame.tilt;

  // The middle of a chord over the angle 2 h lies r (1 - cos h) inside. Chords round the axis and
  // chords along it may each contribute half of the error.
  const double radius = std::max(capsule.ra, capsule.rb);
  const double half = std::acos(1.0 - std::min(0.5 * chord_error / radius, 0.5));
  const int around = std::max(8, static_cast<int>(std::ceil(pi / half)));
  const std::vector<Ring> rings = rings_of(tilt, 2.0 * half);

  const int columns = around + 1;
  const auto ring_count = static_cast<int>(rings.size());
  CapsuleMesh mesh;
  mesh.vertices.resize(3, ring_count * columns);
  mesh.normals.resize(3, ring_count * columns);
  mesh.where.resize(2, ring_count * columns);
  for (int r = 0; r < ring_count; ++r) {
    const auto [angle, at_b] = rings[r];
    const double ring_radius = at_b ? capsule.rb : capsule.ra;
    const double arc = at_b ? capsule.ra * (tilt + 0.5 * pi) + frame.length * std::cos(tilt) +
                                  capsule.rb * (angle - tilt)
                            : capsule.ra * (angle + 0.5 * pi);
    for (int c = 0; c < columns; ++c) {
      const double turn = 2.0 * pi * c / around;
      const Vector3d normal =
          std::cos(angle) * (std::cos(turn) * frame.e1 + std::sin(turn) * frame.e2) +
          std::sin(angle) * frame.axis;
      const int i = r * columns + c;
      mesh.normals.col(i) = normal;
      mesh.vertices.col(i) = (at_b ? capsule.b : capsule.a) + ring_radius * normal;
      mesh.where.col(i) << arc, turn;
    }
  }
  mesh.triangles = triangles_between(ring_count, around);
  return mesh;
}

}  // namespace palpable
