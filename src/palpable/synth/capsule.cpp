#include "palpable/synth/capsule.h"

#include "palpable/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpable {

namespace {

Eigen::Vector3d unit_or(const Eigen::Vector3d& v, const Eigen::Vector3d& otherwise) {
  const double length = v.norm();
  return length > 1e-12 ? Eigen::Vector3d(v / length) : otherwise;
}

}  // namespace

CapsuleField::CapsuleField(const Capsule& capsule) : capsule_(capsule) {
  const Eigen::Vector3d ab = capsule.b - capsule.a;
  const double length = ab.norm();
  is_sphere_ = length <= std::abs(capsule.ra - capsule.rb);
  if (is_sphere_) return;
  axis_ = ab / length;
  sine_ = (capsule.ra - capsule.rb) / length;
  cosine_ = std::sqrt(1.0 - sine_ * sine_);
  along_end_ = cosine_ * length;
}

CapsuleField::Profile CapsuleField::profile_of(const Eigen::Vector3d& x) const {
  const Eigen::Vector3d ax = x - capsule_.a;
  Profile p{};
  p.axial = ax.dot(axis_);
  p.radial = std::sqrt(std::max(0.0, ax.squaredNorm() - p.axial * p.axial));
  p.along = cosine_ * p.axial - sine_ * p.radial;
  return p;
}

double CapsuleField::distance(const Eigen::Vector3d& x) const {
  const auto& [a, b, ra, rb] = capsule_;
  if (is_sphere_) return ra >= rb ? (x - a).norm() - ra : (x - b).norm() - rb;
  const Profile p = profile_of(x);
  if (p.along <= 0.0) return (x - a).norm() - ra;
  if (p.along >= along_end_) return (x - b).norm() - rb;
  return cosine_ * p.radial + sine_ * p.axial - ra;
}

Eigen::Vector3d CapsuleField::normal(const Eigen::Vector3d& x) const {
  const auto& [a, b, ra, rb] = capsule_;
  const Eigen::Vector3d any = Eigen::Vector3d::UnitX();
  if (is_sphere_) return unit_or(ra >= rb ? x - a : x - b, any);
  const Profile p = profile_of(x);
  if (p.along <= 0.0) return unit_or(x - a, any);
  if (p.along >= along_end_) return unit_or(x - b, any);
  const Eigen::Vector3d outwards = unit_or(x - a - p.axial * axis_, axis_.unitOrthogonal());
  return cosine_ * outwards + sine_ * axis_;
}

double signed_distance(const Capsule& capsule, const Eigen::Vector3d& x) {
  return CapsuleField(capsule).distance(x);
}

double signed_distance(std::span<const Capsule> capsules, const Eigen::Vector3d& x) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Capsule& capsule : capsules) nearest = std::min(nearest, signed_distance(capsule, x));
  return nearest;
}

Eigen::Vector3d distance_normal(const Capsule& capsule, const Eigen::Vector3d& x) {
  return CapsuleField(capsule).normal(x);
}

double ray_distance(std::span<const Capsule> capsules, const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& direction, double reach) {
  double t = 0.0;
  while (t < reach) {
    const double step = signed_distance(capsules, origin + t * direction);
    if (step < 1e-6) return t;
    t += step;
  }
  return std::numeric_limits<double>::infinity();
}

CapsuleMesh tessellate(const Capsule& capsule, const Eigen::Vector3d& side, double chord_error) {
  PALPABLE_EXPECT(capsule.ra > 0.0 && capsule.rb > 0.0 && chord_error > 0.0,
                  "radii and the chord error are positive");
  using std::numbers::pi;
  Eigen::Vector3d axis = capsule.b - capsule.a;
  const double length = axis.norm();
  // A sphere in a sphere has no tangent line; the bound keeps the asin in its domain.
  const double tilt = length > 0.0
                          ? std::asin(std::clamp((capsule.ra - capsule.rb) / length, -1.0, 1.0))
                          : 0.5 * pi;
  axis = length > 0.0 ? Eigen::Vector3d(axis / length) : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d e1 = unit_or(side - side.dot(axis) * axis, axis.unitOrthogonal());
  const Eigen::Vector3d e2 = axis.cross(e1);

  // A chord over the angle 2h lies r (1 - cos h) inside; both directions share the error.
  const double radius = std::max(capsule.ra, capsule.rb);
  const double half = std::acos(1.0 - std::min(0.5 * chord_error / radius, 0.5));
  const int around = std::max(8, static_cast<int>(std::ceil(pi / half)));
  const auto arcs = [&](double angle) {
    return std::max(1, static_cast<int>(std::ceil(angle / (2.0 * half))));
  };
  const int arcs_a = arcs(tilt + 0.5 * pi);
  const int arcs_b = arcs(0.5 * pi - tilt);

  struct Ring {
    double angle;  // of the normal, from the axis' perpendicular
    bool at_b;
  };
  std::vector<Ring> rings;
  for (int i = 0; i <= arcs_a; ++i)
    rings.push_back({-0.5 * pi + (tilt + 0.5 * pi) * i / arcs_a, false});
  for (int i = 0; i <= arcs_b; ++i) rings.push_back({tilt + (0.5 * pi - tilt) * i / arcs_b, true});

  const int columns = around + 1;  // the seam is doubled: its angle is both 0 and 2 pi
  const auto ring_count = static_cast<int>(rings.size());
  CapsuleMesh mesh;
  mesh.vertices.resize(3, ring_count * columns);
  mesh.normals.resize(3, ring_count * columns);
  mesh.where.resize(2, ring_count * columns);
  for (int r = 0; r < ring_count; ++r) {
    const auto [angle, at_b] = rings[static_cast<std::size_t>(r)];
    const double ring_radius = at_b ? capsule.rb : capsule.ra;
    const double arc = at_b ? capsule.ra * (tilt + 0.5 * pi) + length * std::cos(tilt) +
                                  capsule.rb * (angle - tilt)
                            : capsule.ra * (angle + 0.5 * pi);
    for (int c = 0; c < columns; ++c) {
      const double turn = 2.0 * pi * c / around;
      const Eigen::Vector3d normal =
          std::cos(angle) * (std::cos(turn) * e1 + std::sin(turn) * e2) + std::sin(angle) * axis;
      const int i = r * columns + c;
      mesh.normals.col(i) = normal;
      mesh.vertices.col(i) = (at_b ? capsule.b : capsule.a) + ring_radius * normal;
      mesh.where.col(i) << arc, turn;
    }
  }
  mesh.triangles.resize(3, 2 * (ring_count - 1) * around);
  int t = 0;
  for (int r = 0; r + 1 < ring_count; ++r)
    for (int c = 0; c < around; ++c) {
      const int i = r * columns + c;
      mesh.triangles.col(t++) << i, i + 1, i + columns + 1;
      mesh.triangles.col(t++) << i, i + columns + 1, i + columns;
    }
  return mesh;
}

}  // namespace palpable
