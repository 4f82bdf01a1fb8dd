#include "palpable/live/seen_object/ball_union.h"

#include <algorithm>
#include <array>

namespace palpable {
namespace {

using Eigen::Vector3f;

// Distance over which slope and curvature are taken by differences, as a ratio to the ball's
// radius. Larger steps smooth the dents between balls, and edges as well.
constexpr float kShapeStep = 0.5f;

constexpr float kAmid = 1e-6f;  // m: nearer to a ball's centre than this, the normal is undefined
constexpr float kHalfRoot = 0.70710678f;

}  // namespace

void BallUnion::reserve(std::size_t balls) {
  balls_.reserve(balls);
  bare_.reserve(balls);
  tree_.reserve(balls);
}

// Makes what queries need of the balls.
void BallUnion::arrange() {
  bare_.clear();
  bounds_.setEmpty();
  for (const ObjectBall& ball : balls_) {
    bare_.push_back({ball.centre, ball.radius});
    const Vector3f radius = Vector3f::Constant(ball.radius);
    bounds_.extend(Eigen::AlignedBox3f(ball.centre - radius, ball.centre + radius));
  }
  find_friction_share();
  tree_.build(bare_);
}

void BallUnion::set_on_the_way(const BallUnion& now, float done) {
  camera_ = now.camera_;
  balls_.assign(now.balls_.begin(), now.balls_.end());
  for (ObjectBall& ball : balls_) {
    const Vector3f to_come = (1 - done) * ball.way;
    ball.centre -= to_come;
    ball.point -= to_come;
    ball.way *= done;
  }
  arrange();
}

void BallUnion::find_friction_share() {
  friction_share_ = 0;
  for (const ObjectBall& ball : balls_) {
    friction_share_ = std::max(friction_share_, ball.friction_share);
  }
}

NearestOnObject BallUnion::on_ball(const Vector3f& x, float distance, int index) const {
  const ObjectBall& ball = balls_[index];
  const bool faces_camera = (x - ball.centre).dot(camera_ - ball.centre) > 0.0f;
  return {distance, index,
          ball.unseen_for > 0 ? Known::kUnknown
          : faces_camera      ? Known::kMeasured
                              : Known::kAssumed};
}

std::optional<NearestOnObject> BallUnion::nearest(const Vector3f& x, float reach) const {
  const auto found = tree_.nearest(x, reach);
  if (!found) return std::nullopt;
  return on_ball(x, found->distance, found->ball);
}

std::optional<SurfaceShape> BallUnion::shape_at(const Vector3f& x) const {
  const auto found = nearest(x);
  if (!found) return std::nullopt;
  const ObjectBall& ball = balls_[found->ball];
  const Vector3f out = x - ball.centre;
  const Vector3f n = out.norm() > kAmid ? Vector3f(out.normalized()) : ball.normal;
  const float h = kShapeStep * ball.radius;
  const Vector3f t = n.unitOrthogonal(), s = n.cross(t);
  // Slope and curvature along four directions of the tangent plane, 45 degrees apart, from phi at x
  // and at +-h. On a sphere of radius R the mean of phi at +-h exceeds phi at x by d with
  // (R + d)^2 = R^2 + h^2, so that 1/R = 2 d / (h^2 - d^2).
  const std::array<Vector3f, 4> directions{t, ((t + s) * kHalfRoot).eval(), s,
                                           ((s - t) * kHalfRoot).eval()};
  std::array<Vector3f, 8> places;
  for (std::size_t k = 0; k < 4; ++k) {
    places[2 * k] = x + h * directions[k];
    places[2 * k + 1] = x - h * directions[k];
  }
  const std::array<float, 8> there = tree_.distances_around(x, n, h, places, found->ball);
  Vector3f slope = Vector3f::Zero();
  std::array<float, 4> bend{};
  for (std::size_t k = 0; k < 4; ++k) {
    const float ahead = there[2 * k], behind = there[2 * k + 1];
    slope += (ahead - behind) / (4 * h) * directions[k];
    const float d = (ahead + behind) / 2 - found->distance;
    bend[k] = 2 * d / (h * h - d * d);
  }
  // A symmetric tensor (a b; b c) has the curvatures a, (a + c)/2 + b, c, (a + c)/2 - b along them.
  const float mean = (bend[0] + bend[1] + bend[2] + bend[3]) / 4;
  const float a = mean + (bend[0] - bend[2]) / 2, c = mean - (bend[0] - bend[2]) / 2;
  const float b = (bend[1] - bend[3]) / 2;
  const Eigen::Matrix3f K =
      a * t * t.transpose() + b * (t * s.transpose() + s * t.transpose()) + c * s * s.transpose();
  const Vector3f normal = (n + slope).normalized();
  const Eigen::Matrix3f across = Eigen::Matrix3f::Identity() - normal * normal.transpose();
  return SurfaceShape{found->distance, normal,          across * K * across, ball.sigma,
                      found->known,    ball.unseen_for, ball.friction_share};
}

}  // namespace palpable
