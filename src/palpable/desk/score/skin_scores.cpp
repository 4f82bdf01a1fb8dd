#include "palpable/desk/score/skin_scores.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpable {

using Eigen::Vector3d;

namespace {

constexpr int kMostHalvings = 12;  // splits an edge into 4096 parts

constexpr double kNear = 0.020;        // m, distance from the body at which a capsule counts
constexpr std::size_t kLateSteps = 2;  // frames by which a response may be late

// For each capsule whether it is within kNear of a drawn vertex.
std::vector<bool> near_body(const PopFrame& frame) {
  const Eigen::Matrix3Xd surface = (frame.camera_from_body.linear() * frame.surface).colwise() +
                                   frame.camera_from_body.translation();
  std::vector<bool> near;
  for (const Capsule& capsule : frame.hand) {
    const double reach = std::max(capsule.ra, capsule.rb) + kNear;
    const Eigen::Vector3d low = capsule.a.cwiseMin(capsule.b).array() - reach;
    const Eigen::Vector3d high = capsule.a.cwiseMax(capsule.b).array() + reach;
    bool is_near = false;
    for (Eigen::Index k = 0; k < surface.cols() && !is_near; ++k) {
      const auto x = surface.col(k);
      if ((x.array() < low.array()).any() || (x.array() > high.array()).any()) continue;
      is_near = distance_to(capsule, x) <= kNear;
    }
    near.push_back(is_near);
  }
  return near;
}

bool any(const std::vector<bool>& flags) {
  return std::find(flags.begin(), flags.end(), true) != flags.end();
}

// m_n (PopScorer); nothing when the two frames cannot be compared.
std::optional<double> hand_motion(const PopFrame& before, const PopFrame& now) {
  const std::vector<bool> near_before = near_body(before);
  const std::vector<bool> near_now = near_body(now);
  if (!any(near_before) && !any(near_now)) return 0.0;
  if (near_before.size() != near_now.size()) return std::nullopt;
  double farthest = 0;
  for (std::size_t k = 0; k < near_now.size(); ++k) {
    if (!near_before[k] && !near_now[k]) continue;
    for (const auto end : {&Capsule::a, &Capsule::b}) {
      const Eigen::Vector3d from = before.world_from_camera * (before.hand[k].*end);
      const Eigen::Vector3d to = now.world_from_camera * (now.hand[k].*end);
      farthest = std::max(farthest, (to - from).norm());
    }
  }
  return farthest;
}

double mean_distance(const SurfaceMesh& from, const SurfaceDistance& to) {
  const Eigen::VectorXd areas = vertex_areas(from);
  double sum = 0;
  for (int v = 0; v < from.vertex_count(); ++v) {
    sum += areas[v] * std::abs(to.nearest(from.vertices.col(v)).distance);
  }
  return sum / areas.sum();
}

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

double deepest_penetration(const SurfaceMesh& surface, std::span<const Capsule> capsules) {
  double deepest = 0;
  for (const Capsule& capsule : capsules) {
    DeepestSample sample(capsule, deepest);
    for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
      const auto corner = surface.triangles.col(t);
      sample.look_at(surface.vertices.col(corner[0]), surface.vertices.col(corner[1]),
                     surface.vertices.col(corner[2]));
    }
    deepest = sample.depth();
  }
  return deepest;
}

void PopScorer::add(PopFrame frame) {
  PALPABLE_EXPECT(!last_ || frame.surface.cols() == last_->surface.cols(),
                  "the drawn surface keeps its vertices");
  std::optional<double> moved;
  if (last_) moved = hand_motion(*last_, frame);
  if (!moved) {
    moved_.clear();
  } else {
    double explained = *moved;
    for (const double earlier : moved_) explained = std::max(explained, earlier);
    const double jump = (frame.surface - last_->surface).colwise().norm().maxCoeff();
    const double size = std::max(0.0, jump - explained);
    if (!largest_ || size > largest_->size) largest_ = Pop{size, frame.number};
    counted_ += size > kCountedPop;
    moved_.push_front(*moved);
    if (moved_.size() > kLateSteps) moved_.pop_back();
  }
  last_ = std::move(frame);
}

double skin_offset(const SurfaceMesh& a, const SurfaceMesh& b) {
  return std::max(mean_distance(a, SurfaceDistance(b)), mean_distance(b, SurfaceDistance(a)));
}

double placement_error(const Eigen::Matrix3Xd& rest, const Rigid3& truth, const Rigid3& drawn) {
  PALPABLE_EXPECT(rest.cols() > 0, "a body has vertices");
  const Eigen::Matrix3d turned = drawn.linear() - truth.linear();
  const Eigen::Vector3d shifted = drawn.translation() - truth.translation();
  return ((turned * rest).colwise() + shifted).colwise().norm().maxCoeff();
}

}  // namespace palpable
