#include "palpable/desk/script/contact_truth.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <vector>

namespace palpable {

ContactTruth contact_truth(std::span<const Capsule> hand, const Eigen::Matrix3Xd& vertices,
                           double farthest) {
  // The distance to a ball that contains a capsule is a lower bound of the distance to the capsule.
  // If the bound is not below the smallest distance so far, the exact distance need not be
  // computed.
  struct Ball {
    Eigen::Vector3d centre;
    double radius;
  };
  std::vector<Ball> balls;
  for (const Capsule& c : hand)
    balls.push_back({0.5 * (c.a + c.b), 0.5 * (c.b - c.a).norm() + std::max(c.ra, c.rb)});

  ContactTruth truth;
  double nearest = farthest;
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

/// The distance, m, from x, which lies inside the union of the capsules, along `direction` to the
/// surface of the union. Each step is as long as the depth of x in the capsule in which it is
/// deepest, so that no step overshoots.
double way_out(std::span<const Capsule> hand, Eigen::Vector3d x, const Eigen::Vector3d& direction) {
  constexpr double kStop = 1e-6;   // m, shortest step
  constexpr double kReach = 0.10;  // m, largest result; no body is thicker where it is pressed
  double way = 0.0;
  while (way < kReach) {
    const double step = -signed_distance(hand, x);
    if (step < kStop) break;
    way += step;
    x += step * direction;
  }
  return way;
}

using Eigen::AlignedBox3d;

/// Capsules with bounding boxes, which quickly reject most points outside the hand.
class BoxedHand {
 public:
  explicit BoxedHand(std::span<const Capsule> hand) : hand_(hand) {
    for (const Capsule& c : hand) {
      boxes_.push_back(box_of(c));
      all_.extend(boxes_.back());
    }
  }

  [[nodiscard]] bool holds(const Eigen::Vector3d& x) const {
    if (!all_.contains(x)) return false;
    for (std::size_t i = 0; i < boxes_.size(); ++i)
      if (boxes_[i].contains(x) && signed_distance(hand_[i], x) < 0.0) return true;
    return false;
  }

 private:
  std::span<const Capsule> hand_;
  std::vector<AlignedBox3d> boxes_;
  AlignedBox3d all_;
};

/// The capsules whose boxes overlap the bounding box of the points.
std::vector<Capsule> near_ones(std::span<const Capsule> hand, const Eigen::Matrix3Xd& points) {
  const AlignedBox3d all{points.rowwise().minCoeff(), points.rowwise().maxCoeff()};
  std::vector<Capsule> near;
  for (const Capsule& c : hand)
    if (box_of(c).intersects(all)) near.push_back(c);
  return near;
}

}  // namespace

bool touches(std::span<const Capsule> hand, const Eigen::Matrix3Xd& points) {
  const BoxedHand boxed(hand);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (boxed.holds(points.col(i))) return true;
  return false;
}

PressTruth press_truth(std::span<const Capsule> hand, const SurfacePoints& body) {
  const BoxedHand boxed(hand);
  std::vector<Capsule> near;  // computed at the first point inside
  PressTruth truth;
  for (Eigen::Index i = 0; i < body.points.cols(); ++i) {
    if (!boxed.holds(body.points.col(i))) continue;
    if (near.empty()) near = near_ones(hand, body.points);
    const double depth = way_out(near, body.points.col(i), body.inwards.col(i));
    if (truth.point >= 0 && depth <= truth.depth) continue;
    truth = {true, depth, static_cast<int>(i)};
  }
  return truth;
}

}  // namespace palpable
