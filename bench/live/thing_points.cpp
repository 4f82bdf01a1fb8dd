#include "bench/live/thing_points.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpable::app {
namespace {

using Eigen::Vector3d;

// The largest cosine of the angle between normal and ray at an outline.
constexpr double kOutline = 0.15;

// m; a gap along a ray that is shorter than this does not count, e.g. between the
// bones of one palm.
constexpr double kLeastGap = 1e-4;

// Whether a ray from the camera leaves the things between two distances along it.
bool comes_out(std::span<const Capsule> things, const Vector3d& direction, double from, double to) {
  double t = from;
  while (t < to) {
    // The ball of this radius around the point is inside the things.
    const double inside = -signed_distance(things, t * direction);
    if (inside < -kLeastGap) return true;
    t += std::max(inside, kLeastGap);
  }
  return false;
}

struct Candidate {
  Vector3d x, normal;  // camera frame
  int thing;
  bool is_end;
};

// Points on the whole surface of one capsule, which may be inside others.
void add_points(const Capsule& capsule, int thing, double spacing, std::vector<Candidate>& points) {
  const CapsuleField field(capsule);
  const double length = (capsule.b - capsule.a).norm();
  const Vector3d axis =
      length > 1e-9 ? Vector3d((capsule.b - capsule.a) / length) : Vector3d(Vector3d::UnitZ());
  const Vector3d across = axis.unitOrthogonal(), other = axis.cross(across);
  const double widest = std::max(capsule.ra, capsule.rb);
  const int around = std::max(8, static_cast<int>(2 * std::numbers::pi * widest / spacing));
  const int along = std::max(1, static_cast<int>(length / spacing));
  const int round = std::max(3, static_cast<int>(std::numbers::pi / 2 * widest / spacing));
  const auto add = [&](const Vector3d& x, bool is_end) {
    // For a tapered capsule the point is not exactly on the surface; one step along the
    // normal moves it there.
    const Vector3d normal = field.normal(x), on = x - field.distance(x) * normal;
    if (on.allFinite()) points.push_back({on, normal, thing, is_end});
  };
  for (int k = 0; k < around; ++k) {
    const double angle = 2 * std::numbers::pi * k / around;
    const Vector3d out = std::cos(angle) * across + std::sin(angle) * other;
    for (int i = 0; i <= along; ++i) {
      const double t = static_cast<double>(i) / along;
      add(capsule.a + t * (capsule.b - capsule.a) +
              (capsule.ra + t * (capsule.rb - capsule.ra)) * out,
          false);
    }
    for (int i = 1; i <= round; ++i) {
      const double up = std::numbers::pi / 2 * i / round;
      add(capsule.a + capsule.ra * (std::cos(up) * out - std::sin(up) * axis), true);
      add(capsule.b + capsule.rb * (std::cos(up) * out + std::sin(up) * axis), true);
    }
  }
}

}  // namespace

ThingPoints points_of_things(std::span<const Capsule> things, const PinholeCamera& camera,
                             const Rigid3& body_from_camera, const SurfaceDistance& body,
                             double reach, double spacing) {
  const Eigen::AlignedBox3d bounds(
      body.surface().vertices.rowwise().minCoeff() - Vector3d::Constant(reach),
      body.surface().vertices.rowwise().maxCoeff() + Vector3d::Constant(reach));
  std::vector<Candidate> candidates;
  ThingPoints points;
  for (int i = 0; i < std::ssize(things); ++i) {
    const Capsule& thing = things[static_cast<std::size_t>(i)];
    const Vector3d a = body_from_camera * thing.a, b = body_from_camera * thing.b;
    Eigen::AlignedBox3d box(a.cwiseMin(b), a.cwiseMax(b));
    const Vector3d radius = Vector3d::Constant(std::max(thing.ra, thing.rb));
    if (!bounds.intersects(Eigen::AlignedBox3d(box.min() - radius, box.max() + radius))) continue;
    add_points(thing, i, spacing, candidates);
  }
  for (const auto& [x, normal, thing, is_end] : candidates) {
    if (signed_distance(things, x) < -1e-6) continue;  // inside another capsule
    const Vector3d in_body = body_from_camera * x;
    if (!bounds.contains(in_body)) continue;
    const double u = camera.cx_px + camera.fx_px * x.x() / x.z();
    const double v = camera.cy_px + camera.fy_px * x.y() / x.z();
    if (!(x.z() > 0) || u < 0 || v < 0 || u > camera.width - 1 || v > camera.height - 1) continue;
    if (body.nearest(in_body).distance > reach) continue;
    const double range = x.norm();
    const Vector3d ray = x / range;
    const double first = ray_distance(things, Vector3d::Zero(), ray, range);
    ThingPoint point{x, normal, thing, Side::kFront, is_end, false};
    if (first < range - kHidden) {
      const bool out = comes_out(things, ray, first + kHidden, range - kHidden);
      point.side = out ? Side::kBehind : Side::kBack;
    }
    point.is_outline = point.side != Side::kBehind && std::abs(normal.dot(ray)) < kOutline;
    points.push_back(point);
  }
  return points;
}

}  // namespace palpable::app
