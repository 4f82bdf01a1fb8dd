#include "bench/live/true_hand.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace palpable::app {
namespace {

constexpr double kBetweenBalls = 0.001;  // m, along a capsule

}  // namespace

double force_size(const TouchState& state) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const PointForce& at : state.forces) sum += at.force;
  return static_cast<double>(sum.norm());
}

void add_balls(const Capsule& capsule, const Rigid3& body_from_camera,
               std::vector<ObjectBall>& balls) {
  const int steps =
      std::max(1, static_cast<int>(std::ceil((capsule.b - capsule.a).norm() / kBetweenBalls)));
  for (int k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) / steps;
    ObjectBall ball;
    ball.centre = (body_from_camera * ((1 - t) * capsule.a + t * capsule.b).eval()).cast<float>();
    ball.radius = static_cast<float>((1 - t) * capsule.ra + t * capsule.rb);
    const Eigen::Vector3f to_camera =
        (body_from_camera.translation().cast<float>() - ball.centre).normalized();
    ball.point = ball.centre + ball.radius * to_camera;
    ball.normal = to_camera;
    balls.push_back(ball);
  }
}

std::vector<ObjectBall> balls_of(std::span<const Capsule> capsules,
                                 const Rigid3& body_from_camera) {
  std::vector<ObjectBall> balls;
  for (const Capsule& capsule : capsules) add_balls(capsule, body_from_camera, balls);
  return balls;
}

}  // namespace palpable::app
