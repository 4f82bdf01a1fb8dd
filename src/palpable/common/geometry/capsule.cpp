#include "palpable/common/geometry/capsule.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {

namespace {

Eigen::Vector3d unit_or(const Eigen::Vector3d& v, const Eigen::Vector3d& otherwise) {
  const double length = v.norm();
  return length > 1e-12 ? Eigen::Vector3d(v / length) : otherwise;
}

}  // namespace

Capsule transformed(Capsule capsule, const Rigid3& target_from_source) {
  capsule.a = target_from_source * capsule.a;
  capsule.b = target_from_source * capsule.b;
  return capsule;
}

std::vector<Capsule> transformed(std::vector<Capsule> capsules, const Rigid3& target_from_source) {
  for (Capsule& capsule : capsules) capsule = transformed(capsule, target_from_source);
  return capsules;
}

Capsule interpolated(const Capsule& from, const Capsule& to, double t) {
  const auto mix = [t](const auto& one, const auto& other) { return (1 - t) * one + t * other; };
  const Eigen::Vector3d axis = from.b - from.a, turned = to.b - to.a;
  const auto turn = Eigen::Quaterniond::FromTwoVectors(axis, turned);
  const double length = axis.norm();
  const double share = length > 0 ? mix(length, turned.norm()) / length : 0.0;
  Capsule now;
  now.a = mix(from.a, to.a);
  now.b = now.a + share * (Eigen::Quaterniond::Identity().slerp(t, turn) * axis);
  now.ra = mix(from.ra, to.ra);
  now.rb = mix(from.rb, to.rb);
  return now;
}

Eigen::AlignedBox3d box_of(const Capsule& capsule) {
  const Eigen::Vector3d r = Eigen::Vector3d::Constant(std::max(capsule.ra, capsule.rb));
  return {capsule.a.cwiseMin(capsule.b) - r, capsule.a.cwiseMax(capsule.b) + r};
}

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

Eigen::Matrix3d CapsuleField::curvature(const Eigen::Vector3d& x) const {
  const auto& [a, b, ra, rb] = capsule_;
  // Second derivative of |x - c|.
  const auto of_sphere = [&](const Eigen::Vector3d& c) -> Eigen::Matrix3d {
    const double radius = (x - c).norm();
    if (radius < 1e-12) return Eigen::Matrix3d::Zero();
    const Eigen::Vector3d n = (x - c) / radius;
    return (Eigen::Matrix3d::Identity() - n * n.transpose()) / radius;
  };
  if (is_sphere_) return of_sphere(ra >= rb ? a : b);
  const Profile p = profile_of(x);
  if (p.along <= 0.0) return of_sphere(a);
  if (p.along >= along_end_) return of_sphere(b);
  if (p.radial < 1e-12) return Eigen::Matrix3d::Zero();
  // A cone is curved only around its axis.
  const Eigen::Vector3d outwards = (x - a - p.axial * axis_) / p.radial;
  const Eigen::Vector3d around = axis_.cross(outwards);
  return cosine_ / p.radial * around * around.transpose();
}

double signed_distance(const Capsule& capsule, const Eigen::Vector3d& x) {
  return CapsuleField(capsule).distance(x);
}

double signed_distance(std::span<const Capsule> capsules, const Eigen::Vector3d& x) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Capsule& capsule : capsules) nearest = std::min(nearest, signed_distance(capsule, x));
  return nearest;
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

}  // namespace palpable
