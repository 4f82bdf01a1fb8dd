#include "palpable/script/contact_truth.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace palpable {

ContactTruth contact_truth(std::span<const Capsule> hand, const Eigen::Matrix3Xd& vertices) {
  // The distance to a ball round the capsule is a lower bound of the distance to the capsule. Where
  // the bound is not below the nearest so far, the exact distance need not be computed.
  struct Ball {
    Eigen::Vector3d centre;
    double radius;
  };
  std::vector<Ball> balls;
  for (const Capsule& c : hand)
    balls.push_back({0.5 * (c.a + c.b), 0.5 * (c.b - c.a).norm() + std::max(c.ra, c.rb)});

  ContactTruth truth;
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    const Eigen::Vector3d x = vertices.col(v);
    for (std::size_t i = 0; i < hand.size(); ++i) {
      if ((x - balls[i].centre).norm() - balls[i].radius >= nearest) continue;
      const double distance = signed_distance(hand[i], x);
      if (distance < nearest) {
        nearest = distance;
        truth.vertex = static_cast<int>(v);
      }
    }
  }
  truth.touching = nearest < 0.0;
  truth.depth = std::max(0.0, -nearest);
  truth.clearance = std::max(0.0, nearest);
  if (!truth.touching) truth.vertex = -1;
  return truth;
}

namespace {

/// How far it is from x, which lies inside, along `direction` until the union is left. Each step is
/// as long as x is deep in the capsule in which it is deepest, so no step overshoots.
double way_out(std::span<const Capsule> hand, Eigen::Vector3d x, const Eigen::Vector3d& direction) {
  constexpr double kStop = 1e-6;   // m
  constexpr double kReach = 0.10;  // m: no body is thicker where it is pressed; ends the loop
  double way = 0.0;
  while (way < kReach) {
    const double step = -signed_distance(hand, x);
    if (step < kStop) break;
    way += step;
    x += step * direction;
  }
  return way;
}

/// A capsule with its bounding box: most points are outside of the box, which is quick to find out.
struct Boxed {
  Capsule capsule;
  Eigen::Array3d low, high;
};

/// The capsules whose boxes overlap the bounding box of the points.
std::vector<Boxed> near_ones(std::span<const Capsule> hand, const Eigen::Matrix3Xd& points) {
  std::vector<Boxed> near;
  if (points.cols() == 0) return near;
  const Eigen::Array3d low = points.rowwise().minCoeff();
  const Eigen::Array3d high = points.rowwise().maxCoeff();
  for (const Capsule& c : hand) {
    const double r = std::max(c.ra, c.rb);
    const Boxed boxed{c, c.a.cwiseMin(c.b).array() - r, c.a.cwiseMax(c.b).array() + r};
    if ((boxed.low <= high).all() && (boxed.high >= low).all()) near.push_back(boxed);
  }
  return near;
}

bool is_inside(const std::vector<Boxed>& near, const Eigen::Vector3d& x) {
  for (const Boxed& one : near) {
    if ((x.array() < one.low).any() || (x.array() > one.high).any()) continue;
    if (signed_distance(one.capsule, x) < 0.0) return true;
  }
  return false;
}

}  // namespace

bool touches(std::span<const Capsule> hand, const Eigen::Matrix3Xd& points) {
  const std::vector<Boxed> near = near_ones(hand, points);
  for (Eigen::Index i = 0; !near.empty() && i < points.cols(); ++i)
    if (is_inside(near, points.col(i))) return true;
  return false;
}

PressTruth press_truth(std::span<const Capsule> hand, const SurfacePoints& body) {
  const std::vector<Boxed> near = near_ones(hand, body.points);
  std::vector<Capsule> capsules;
  for (const Boxed& one : near) capsules.push_back(one.capsule);
  PressTruth truth;
  for (Eigen::Index i = 0; !near.empty() && i < body.points.cols(); ++i) {
    if (!is_inside(near, body.points.col(i))) continue;
    const double depth = way_out(capsules, body.points.col(i), body.inwards.col(i));
    if (truth.point >= 0 && depth <= truth.depth) continue;
    truth = {true, depth, static_cast<int>(i)};
  }
  return truth;
}

}  // namespace palpable
