#include "palpable/desk/score/deepest_sample.h"

#include <algorithm>
#include <cmath>

namespace palpable {

using Eigen::Vector3d;

namespace {

constexpr int kMostHalvings = 12;  // splits an edge into 4096 parts

}  // namespace

double distance_to(const Capsule& capsule, const Vector3d& x) {
  const Vector3d ab = capsule.b - capsule.a;
  const double length = ab.norm();
  const double narrowing = capsule.ra - capsule.rb;
  const double in_a = (x - capsule.a).norm() - capsule.ra;
  const double in_b = (x - capsule.b).norm() - capsule.rb;
  // The larger end ball contains all others.
  if (length <= std::abs(narrowing)) return std::min(in_a, in_b);

  // |x - c| - r(c) is convex in c; its derivative is 0 where the line from c to x is inclined by
  // alpha towards the narrow end, sin alpha = (ra - rb) / |ab|.
  const Vector3d axis = ab / length;
  const double along = (x - capsule.a).dot(axis);
  const double beside = (x - capsule.a - along * axis).norm();
  const double sine = narrowing / length;
  const double c = std::clamp(along - beside * sine / std::sqrt(1 - sine * sine), 0.0, length);
  return (x - capsule.a - c * axis).norm() - (capsule.ra - sine * c);
}

DeepestSample::DeepestSample(const Capsule& capsule, double from)
    : capsule_(capsule), depth_(from) {
  const double reach = std::max(capsule.ra, capsule.rb) + std::max(0.0, -from);
  low_ = capsule.a.cwiseMin(capsule.b).array() - reach;
  high_ = capsule.a.cwiseMax(capsule.b).array() + reach;
}

bool DeepestSample::look_at(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double before = depth_;
  halve(a, b, c, kMostHalvings);
  return depth_ > before;
}

void DeepestSample::halve(const Vector3d& a, const Vector3d& b, const Vector3d& c, int halvings) {
  if (misses_box(a, b, c)) return;
  // The depth is a 1-Lipschitz function of position: nowhere in the triangle does it exceed the
  // depth at the centroid by more than the distance to the farthest corner.
  const Vector3d middle = (a + b + c) / 3;
  const double reach = std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()});
  if (reach - distance_to(capsule_, middle) <= depth_) return;
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  if (longest <= kSampleSpacing || halvings == 0) {
    for (const Vector3d* corner : {&a, &b, &c}) {
      const double depth = -distance_to(capsule_, *corner);
      if (depth <= depth_) continue;
      depth_ = depth;
      point_ = *corner;
    }
    return;
  }
  const Vector3d ab = 0.5 * (a + b);
  const Vector3d bc = 0.5 * (b + c);
  const Vector3d ca = 0.5 * (c + a);
  halve(a, ab, ca, halvings - 1);
  halve(ab, b, bc, halvings - 1);
  halve(ca, bc, c, halvings - 1);
  halve(ab, bc, ca, halvings - 1);
}

bool DeepestSample::misses_box(const Vector3d& a, const Vector3d& b, const Vector3d& c) const {
  return (a.array().min(b.array()).min(c.array()) > high_).any() ||
         (a.array().max(b.array()).max(c.array()) < low_).any();
}

}  // namespace palpable
