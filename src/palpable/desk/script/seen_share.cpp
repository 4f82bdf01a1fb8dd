#include "palpable/desk/script/seen_share.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpable {

using Eigen::Vector3d;

namespace {

/// Points that cover a capsule's surface: rings round its axis on both ends and on the cone
/// between.
///
/// The profile of the surface in a half plane through the axis consists of an arc round a, a line
/// and an arc round b. The line touches both circles where the angle from the axis has the cosine
/// (ra - rb) / length.
std::vector<Vector3d> points_on(Capsule capsule, double spacing) {
  const double length = (capsule.b - capsule.a).norm();
  if (length <= std::abs(capsule.ra - capsule.rb)) {  // the capsule is a sphere
    const bool first = capsule.ra >= capsule.rb;
    const Vector3d centre = first ? capsule.a : capsule.b;
    const double radius = std::max(capsule.ra, capsule.rb);
    capsule = {centre, centre + Vector3d::UnitZ() * 1e-9, radius, radius};
  }
  const auto& [a, b, ra, rb] = capsule;
  const Vector3d axis = (b - a).normalized();
  const Vector3d side = axis.unitOrthogonal(), other = axis.cross(side);
  const double slope = std::acos(std::clamp((ra - rb) / (b - a).norm(), -1.0, 1.0));

  std::vector<Vector3d> points;
  const auto ring = [&](const Vector3d& centre, double radius) {
    const int count =
        std::max(1, static_cast<int>(std::ceil(2.0 * std::numbers::pi * radius / spacing)));
    for (int i = 0; i < count; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / count;
      points.push_back(centre + radius * (std::cos(angle) * side + std::sin(angle) * other));
    }
  };
  // Rings along an arc round a centre, between two angles from the axis.
  const auto arc = [&](const Vector3d& centre, double radius, double from, double to) {
    const int steps = std::max(1, static_cast<int>(std::ceil(radius * (to - from) / spacing)));
    for (int i = 0; i <= steps; ++i) {
      const double angle = from + (to - from) * i / steps;
      ring(centre + radius * std::cos(angle) * axis, radius * std::sin(angle));
    }
  };
  arc(b, rb, 0.0, slope);
  arc(a, ra, slope, std::numbers::pi);
  const Vector3d tilt = std::cos(slope) * axis;
  const Vector3d from = a + ra * tilt, to = b + rb * tilt;
  const int steps = static_cast<int>(std::ceil((to - from).norm() / spacing));
  for (int i = 1; i < steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    ring(from + t * (to - from), std::sin(slope) * (ra + t * (rb - ra)));
  }
  return points;
}

}  // namespace

Eigen::Matrix3Xd touching_part(std::span<const Capsule> movers, const SurfaceDistance& body,
                               double spacing, int most) {
  PALPABLE_EXPECT(spacing > 0 && most > 0, "spacing and number of points are positive");
  constexpr double kOnSurface = 1e-9;  // m, rounding; a deeper point lies inside another capsule
  std::vector<Vector3d> inside;
  for (const Capsule& capsule : movers) {
    const double reach = 0.5 * (capsule.b - capsule.a).norm() + std::max(capsule.ra, capsule.rb);
    if (body.nearest(0.5 * (capsule.a + capsule.b)).distance > reach) continue;
    // If the body is at distance d from a point, no point within d of it is inside the body, so
    // that the distances of most neighbouring points need not be computed.
    Vector3d known = Vector3d::Zero();
    double away = 0.0;
    for (const Vector3d& x : points_on(capsule, spacing)) {
      if ((x - known).norm() < away - kOnSurface || signed_distance(movers, x) <= -kOnSurface)
        continue;
      known = x;
      away = body.nearest(x).distance;
      if (away < 0.0) inside.push_back(x);
    }
  }
  const int found = static_cast<int>(inside.size()), kept = std::min(found, most);
  Eigen::Matrix3Xd points(3, kept);
  for (int i = 0; i < kept; ++i) points.col(i) = inside[static_cast<long long>(i) * found / kept];
  return points;
}

double seen_share(const Eigen::Matrix3Xd& points, std::span<const Capsule> movers,
                  const RectifiedStereo& eyes) {
  // The ray ends on the movers' surface at the point itself, so its last part is not tested.
  constexpr double kBeforePoint = 1e-4;  // m
  const auto in_picture = [&](const Vector3d& x) {
    if (x.z() <= 0.0) return false;
    const Eigen::Vector2d pixel = eyes.camera.project(x);
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= eyes.camera.width - 0.5 &&
           pixel.y() <= eyes.camera.height - 0.5;
  };
  const auto is_free = [&](const Vector3d& eye, const Vector3d& x) {
    const double way = (x - eye).norm();
    return std::isinf(ray_distance(movers, eye, (x - eye) / way, way - kBeforePoint));
  };
  const Vector3d right(eyes.baseline, 0.0, 0.0);
  int seen = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d x = points.col(i);
    if (!in_picture(x)) continue;
    if (is_free(Vector3d::Zero(), x) || (in_picture(x - right) && is_free(right, x))) ++seen;
  }
  return points.cols() > 0 ? static_cast<double>(seen) / static_cast<double>(points.cols()) : 0.0;
}

}  // namespace palpable
