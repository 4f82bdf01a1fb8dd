#include "palpable/synth/contact_truth.h"

#include <algorithm>
#include <limits>

namespace palpable {

ContactTruth contact_truth(std::span<const Capsule> hand, const Eigen::Matrix3Xd& vertices) {
  // A ball round each capsule gives a lower bound of the distance, which spares most of the exact
  // ones: the answer is the same.
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

std::vector<int> vertices_inside(std::span<const Capsule> hand, const Eigen::Matrix3Xd& vertices) {
  std::vector<int> inside;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    if (signed_distance(hand, vertices.col(v)) < 0.0) inside.push_back(static_cast<int>(v));
  return inside;
}

}  // namespace palpable
