#include "palpable/bake/solid/obstacle.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {

using Eigen::Vector3d;

namespace {

constexpr double kMostPieces = 100;  // into which core() divides a capsule's axis

}  // namespace

Capsule ball(const Vector3d& centre, double radius) { return {centre, centre, radius, radius}; }

Obstacle moved(Obstacle obstacle, const Rigid3& target_from_source) {
  obstacle.capsules = transformed(std::move(obstacle.capsules), target_from_source);
  for (HalfSpace& half : obstacle.half_spaces) {
    half.point = target_from_source * half.point;
    half.normal = target_from_source.linear() * half.normal;
  }
  for (PlacedSurface& surface : obstacle.surfaces) {
    surface.body_from_shape = target_from_source * surface.body_from_shape;
  }
  return obstacle;
}

Obstacle interpolated(const Obstacle& from, const Obstacle& to, double t) {
  PALPABLE_EXPECT(has_same_parts(from, to), "an obstacle on its way has the same parts");
  const auto mix = [t](const Vector3d& one, const Vector3d& other) -> Vector3d {
    return (1 - t) * one + t * other;
  };
  Obstacle now = to;
  for (std::size_t k = 0; k < to.capsules.size(); ++k) {
    now.capsules[k] = interpolated(from.capsules[k], to.capsules[k], t);
  }
  for (std::size_t k = 0; k < to.half_spaces.size(); ++k) {
    const HalfSpace &one = from.half_spaces[k], &other = to.half_spaces[k];
    const auto turn = Eigen::Quaterniond::FromTwoVectors(one.normal, other.normal);
    now.half_spaces[k] = {mix(one.point, other.point),
                          Eigen::Quaterniond::Identity().slerp(t, turn) * one.normal};
  }
  for (std::size_t k = 0; k < to.surfaces.size(); ++k) {
    const Rigid3 &one = from.surfaces[k].body_from_shape, &other = to.surfaces[k].body_from_shape;
    Rigid3& pose = now.surfaces[k].body_from_shape;
    pose.linear() = Eigen::Quaterniond(one.linear())
                        .slerp(t, Eigen::Quaterniond(other.linear()))
                        .toRotationMatrix();
    pose.translation() = mix(one.translation(), other.translation());
  }
  return now;
}

PartKind part_kind(const Obstacle& obstacle, int part) {
  const auto capsules = static_cast<int>(obstacle.capsules.size());
  if (part < capsules) return PartKind::kCapsule;
  const auto halves = static_cast<int>(obstacle.half_spaces.size());
  return part < capsules + halves ? PartKind::kHalfSpace : PartKind::kSurface;
}

bool has_same_parts(const Obstacle& a, const Obstacle& b) {
  return a.capsules.size() == b.capsules.size() && a.half_spaces.size() == b.half_spaces.size() &&
         a.surfaces.size() == b.surfaces.size();
}

Vector3d carried(const Obstacle& from, int from_part, const Obstacle& to, int to_part,
                 const Vector3d& x) {
  const auto turned = [&x](const Vector3d& old_origin, const Vector3d& old_direction,
                           const Vector3d& origin, const Vector3d& direction) -> Vector3d {
    const bool has_direction = old_direction.norm() > 0.0 && direction.norm() > 0.0;
    if (!has_direction) return origin + (x - old_origin);
    return origin + Eigen::Quaterniond::FromTwoVectors(old_direction, direction) * (x - old_origin);
  };
  // The number of a part among those of its kind.
  const auto among_kind = [](const Obstacle& obstacle, int part) {
    const auto capsules = static_cast<int>(obstacle.capsules.size());
    const auto halves = static_cast<int>(obstacle.half_spaces.size());
    if (part < capsules) return static_cast<std::size_t>(part);
    part -= capsules;
    return static_cast<std::size_t>(part < halves ? part : part - halves);
  };
  PALPABLE_EXPECT(part_kind(from, from_part) == part_kind(to, to_part), "parts of one kind");
  const std::size_t a = among_kind(from, from_part), b = among_kind(to, to_part);
  switch (part_kind(from, from_part)) {
    case PartKind::kCapsule: {
      const Capsule &old = from.capsules[a], &now = to.capsules[b];
      return turned(old.a, old.b - old.a, now.a, now.b - now.a);
    }
    case PartKind::kHalfSpace: {
      const HalfSpace &old = from.half_spaces[a], &now = to.half_spaces[b];
      return turned(old.point, old.normal, now.point, now.normal);
    }
    case PartKind::kSurface:
      break;
  }
  return to.surfaces[b].body_from_shape * (from.surfaces[a].body_from_shape.inverse() * x);
}

Vector3d carried(const Obstacle& from, const Obstacle& to, int part, const Vector3d& x) {
  return carried(from, part, to, part, x);
}

double smallest_radius(const Obstacle& obstacle) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Capsule& capsule : obstacle.capsules) {
    smallest = std::min({smallest, capsule.ra, capsule.rb});
  }
  return smallest;
}

ObstacleGaps::ObstacleGaps(Obstacle obstacle) : obstacle_(std::move(obstacle)) {
  capsules_.reserve(obstacle_.capsules.size());
  for (const Capsule& capsule : obstacle_.capsules) capsules_.emplace_back(capsule);
}

double ObstacleGaps::distance(int part, const Vector3d& x) const {
  if (part < static_cast<int>(capsules_.size())) return capsules_[part].distance(x);
  return gap(part, x).distance;
}

double ObstacleGaps::distance(const Vector3d& x) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (int part = 0; part < part_count(); ++part) nearest = std::min(nearest, distance(part, x));
  return nearest;
}

std::vector<Vector3d> ObstacleGaps::core(int part) const {
  std::vector<Vector3d> points;
  const int capsules = static_cast<int>(capsules_.size());
  if (part < capsules) {
    const Capsule& capsule = obstacle_.capsules[part];
    const double length = (capsule.b - capsule.a).norm();
    const double smallest = std::min(capsule.ra, capsule.rb);
    const int pieces = static_cast<int>(std::min(kMostPieces, std::ceil(length / smallest)));
    for (int k = 0; k <= pieces; ++k) {
      const double t = pieces > 0 ? static_cast<double>(k) / pieces : 0.0;
      points.emplace_back(capsule.a + t * (capsule.b - capsule.a));
    }
    return points;
  }
  const int halves = static_cast<int>(obstacle_.half_spaces.size());
  if (part < capsules + halves) return points;
  const PlacedSurface& surface = obstacle_.surfaces[part - capsules - halves];
  const Eigen::Matrix3Xd& vertices = surface.shape->surface().vertices;
  for (const auto& x : vertices.colwise()) points.emplace_back(surface.body_from_shape * x);
  return points;
}

bool ObstacleGaps::may_reach(int part, const Eigen::AlignedBox3d& box) const {
  if (part >= static_cast<int>(capsules_.size())) return true;
  return box_of(obstacle_.capsules[part]).intersects(box);
}

Gap ObstacleGaps::gap(int part, const Vector3d& x) const {
  const int capsules = static_cast<int>(capsules_.size());
  if (part < capsules) {
    const CapsuleField& field = capsules_[part];
    return {field.distance(x), field.normal(x), field.curvature(x)};
  }
  const int halves = static_cast<int>(obstacle_.half_spaces.size());
  if (part < capsules + halves) {
    const HalfSpace& half = obstacle_.half_spaces[part - capsules];
    return {half.normal.dot(x - half.point), half.normal, Eigen::Matrix3d::Zero()};
  }
  const PlacedSurface& surface = obstacle_.surfaces[part - capsules - halves];
  const NearestOnSurface nearest =
      surface.shape->nearest(surface.body_from_shape.inverse(Eigen::Isometry) * x);
  return {nearest.distance, surface.body_from_shape.linear() * nearest.normal,
          Eigen::Matrix3d::Zero()};
}

}  // namespace palpable
