#include "palpable/score/penetration.h"

#include <algorithm>
#include <cmath>

namespace palpable {

double distance_to(const Capsule& capsule, const Eigen::Vector3d& x) {
  const Eigen::Vector3d ab = capsule.b - capsule.a;
  const double length = ab.norm();
  const double narrowing = capsule.ra - capsule.rb;
  const double in_a = (x - capsule.a).norm() - capsule.ra;
  const double in_b = (x - capsule.b).norm() - capsule.rb;
  // One end holds all other balls.
  if (length <= std::abs(narrowing)) return std::min(in_a, in_b);

  // |x - c| - r(c) is convex in c; its derivative is 0 where the line from c to x leans by alpha
  // towards the narrow end, sin alpha = (ra - rb) / |ab|.
  const Eigen::Vector3d axis = ab / length;
  const double along = (x - capsule.a).dot(axis);
  const double beside = (x - capsule.a - along * axis).norm();
  const double sine = narrowing / length;
  const double c = std::clamp(along - beside * sine / std::sqrt(1 - sine * sine), 0.0, length);
  return (x - capsule.a - c * axis).norm() - (capsule.ra - sine * c);
}

double deepest_penetration(const Eigen::Matrix3Xd& vertices, std::span<const Capsule> capsules) {
  double deepest = 0;
  for (const Capsule& capsule : capsules) {
    const double reach = std::max(capsule.ra, capsule.rb);
    const Eigen::Vector3d low = capsule.a.cwiseMin(capsule.b).array() - reach;
    const Eigen::Vector3d high = capsule.a.cwiseMax(capsule.b).array() + reach;
    for (Eigen::Index k = 0; k < vertices.cols(); ++k) {
      const auto x = vertices.col(k);
      if ((x.array() < low.array()).any() || (x.array() > high.array()).any()) continue;
      deepest = std::max(deepest, -distance_to(capsule, x));
    }
  }
  return deepest;
}

}  // namespace palpable
