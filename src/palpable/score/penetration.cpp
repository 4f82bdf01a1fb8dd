#include "palpable/score/penetration.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr int kMostHalvings = 12;

// Looks for the deepest sample of triangles in one capsule.
class DeepestSample {
 public:
  DeepestSample(const Capsule& capsule, double deepest) : capsule_(capsule), deepest_(deepest) {
    const double reach = std::max(capsule.ra, capsule.rb);
    low_ = capsule.a.cwiseMin(capsule.b).array() - reach;
    high_ = capsule.a.cwiseMax(capsule.b).array() + reach;
  }

  [[nodiscard]] double deepest() const { return deepest_; }

  void look_at(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
               int halvings = kMostHalvings) {
    if (misses_box(a, b, c)) return;
    // The depth changes by no more than one goes: nowhere in the triangle is it larger than in its
    // middle by more than the way to the farthest corner.
    const Eigen::Vector3d middle = (a + b + c) / 3;
    const double reach = std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()});
    if (reach - distance_to(capsule_, middle) <= deepest_) return;
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    if (longest <= kPenetrationSpacing || halvings == 0) {
      for (const Eigen::Vector3d* corner : {&a, &b, &c}) {
        deepest_ = std::max(deepest_, -distance_to(capsule_, *corner));
      }
      return;
    }
    const Eigen::Vector3d ab = 0.5 * (a + b);
    const Eigen::Vector3d bc = 0.5 * (b + c);
    const Eigen::Vector3d ca = 0.5 * (c + a);
    look_at(a, ab, ca, halvings - 1);
    look_at(ab, b, bc, halvings - 1);
    look_at(ca, bc, c, halvings - 1);
    look_at(ab, bc, ca, halvings - 1);
  }

 private:
  [[nodiscard]] bool misses_box(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c) const {
    return (a.array().min(b.array()).min(c.array()) > high_).any() ||
           (a.array().max(b.array()).max(c.array()) < low_).any();
  }

  const Capsule& capsule_;
  Eigen::Array3d low_, high_;
  double deepest_;
};

}  // namespace

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

double deepest_penetration(const SurfaceMesh& surface, std::span<const Capsule> capsules) {
  double deepest = 0;
  for (const Capsule& capsule : capsules) {
    DeepestSample sample(capsule, deepest);
    for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
      const auto corner = surface.triangles.col(t);
      sample.look_at(surface.vertices.col(corner[0]), surface.vertices.col(corner[1]),
                     surface.vertices.col(corner[2]));
    }
    deepest = sample.deepest();
  }
  return deepest;
}

}  // namespace palpable
