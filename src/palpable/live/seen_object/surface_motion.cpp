#include "palpable/live/seen_object/surface_motion.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

constexpr std::size_t kMovingBallRoom = 8192;  // balls, as ObjectSurface

// Balls that are asked at most: all of a finger's 100, of a palm's 1,500 every sixth.
constexpr std::size_t kMostAsked = 256;

constexpr double kLongest = 0.2;  // s between frames that know each other

// m: a place that lies deeper in the union than that is on no surface.
constexpr float kInside = 0.0003f;
// Cosine between a place's direction and that to the camera: what faces away more is assumed, and
// jumps.
constexpr float kAway = -0.3f;
constexpr int kSteps = 3;
// Of what all balls around say in all directions: so firm is the way of the whole where they say
// nothing.
constexpr float kFirm = 0.002f;
// m: a place that is off by more than that counts half.
constexpr float kOff = 0.001f;
constexpr float kAtOnce = 0.5f;

// Six directions along axes, eight between them.
const std::array<Vector3f, 14> kBallDirections = [] {
  std::array<Vector3f, 14> directions;
  std::size_t count = 0;
  for (int k = 0; k < 3; ++k) {
    directions[count++] = Vector3f::Unit(k);
    directions[count++] = -Vector3f::Unit(k);
  }
  for (int k = 0; k < 8; ++k) {
    directions[count++] =
        Vector3f(k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f).normalized();
  }
  return directions;
}();

// 1 in the middle, 0 from `reach` on.
float nearness(float squared, float reach) {
  const float left = std::max(1 - squared / (reach * reach), 0.0f);
  return left * left;
}

// The way that fits what was told, and otherwise is `usual`.
Vector3f way_of(const Matrix3f& A, const Vector3f& b, const Vector3f& usual) {
  const float firm = kFirm * A.trace() + 1e-6f;
  return (A + firm * Matrix3f::Identity()).ldlt().solve(b + firm * usual);
}

}  // namespace

SurfaceMotion::SurfaceMotion(const SurfaceMotionSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(
      settings.around > 0 && settings.noise > 0 && settings.reach > 0 && settings.fades > 0,
      "lengths and times are above 0");
  for (auto* balls : {&now_, &before_}) balls->reserve(kMovingBallRoom);
  for (auto* vectors : {&velocities_, &seen_before_}) vectors->reserve(kMovingBallRoom);
  balls_.reserve(kMovingBallRoom);
  bare_.reserve(kMovingBallRoom);
  ways_.reserve(kMostAsked);
  told_.reserve(kMostAsked);
  places_.reserve(kMostAsked * kBallDirections.size());
}

void SurfaceMotion::add(std::span<const ObjectBall> balls, const Vector3f& camera, double time) {
  std::swap(now_, before_);
  seen_before_.clear();
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    if (balls_[k].unseen_for == 0) seen_before_.push_back(velocities_[k]);
  }
  balls_.assign(balls.begin(), balls.end());
  bare_.clear();
  for (const ObjectBall& ball : balls_) {
    if (ball.unseen_for == 0) bare_.push_back({ball.centre, ball.radius});
  }
  now_.build(bare_);
  velocities_.assign(balls_.size(), Vector3f::Zero());
  interval_ = time_ ? time - *time_ : 0;
  time_ = time;
  if (!(interval_ > 0) || interval_ > kLongest) interval_ = 0;
  if (interval_ == 0 || bare_.empty() || before_.balls().empty()) return;
  find_places(camera);
  solve();
}

// m/s, of what was seen nearest to a place in the frame before.
Vector3f SurfaceMotion::before_at(const Vector3f& place) const {
  const auto found = before_.nearest(place, static_cast<float>(settings_.reach));
  return found ? seen_before_[static_cast<std::size_t>(found->ball)] : Vector3f::Zero();
}

// Places on the side of the chosen balls that is seen.
void SurfaceMotion::find_places(const Vector3f& camera) {
  places_.clear();
  told_.clear();
  const std::size_t stride = (bare_.size() + kMostAsked - 1) / kMostAsked;
  for (std::size_t k = 0; k < bare_.size(); k += stride) {
    const Ball& ball = bare_[k];
    const Vector3f to_camera = (camera - ball.centre).normalized();
    const int of = static_cast<int>(told_.size());
    told_.push_back({ball.centre});
    for (const Vector3f& n : kBallDirections) {
      if (n.dot(to_camera) < kAway) continue;
      const Vector3f at = ball.centre + ball.radius * n;
      const auto nearest = now_.nearest(at, kInside);
      if (nearest && nearest->distance < -kInside) continue;
      places_.push_back({at, n, of});
    }
  }
}

void SurfaceMotion::solve() {
  const auto dt = static_cast<float>(interval_);
  const auto reach = static_cast<float>(settings_.reach);
  const auto around = static_cast<float>(settings_.around);
  // From rest, not from what was expected: places that are all far off that would count for
  // nothing.
  ways_.assign(told_.size(), Vector3f::Zero());
  Vector3f all = Vector3f::Zero();
  for (int step = 0; step < kSteps; ++step) {
    for (Told& told : told_) told.A.setZero(), told.b.setZero();
    Matrix3f A = Matrix3f::Zero();
    Vector3f b = Vector3f::Zero();
    for (const Place& place : places_) {
      const Vector3f& way = ways_[static_cast<std::size_t>(place.of)];
      const auto then = before_.nearest(place.at - way, reach);
      if (!then || then->distance < -reach) continue;
      const float off = then->distance;
      const float weight = step == 0 ? 1 : 1 / (1 + off * off / (kOff * kOff));
      Told& told = told_[static_cast<std::size_t>(place.of)];
      const Vector3f n = weight * place.normal;
      told.A += n * place.normal.transpose();
      told.b += n * (off + place.normal.dot(way));
    }
    for (const Told& told : told_) A += told.A, b += told.b;
    all = way_of(A, b, Vector3f::Zero());
    for (std::size_t i = 0; i < told_.size(); ++i) {
      Matrix3f Ai = Matrix3f::Zero();
      Vector3f bi = Vector3f::Zero();
      for (const Told& told : told_) {
        const float k = nearness((told.centre - told_[i].centre).squaredNorm(), around);
        if (k > 0) Ai += k * told.A, bi += k * told.b;
      }
      ways_[i] = way_of(Ai, bi, all);
    }
  }
  const auto noise = static_cast<float>(settings_.noise);
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    if (balls_[k].unseen_for > 0) continue;
    Vector3f way = Vector3f::Zero();
    float sum = 0;
    for (std::size_t i = 0; i < told_.size(); ++i) {
      const float w = nearness((told_[i].centre - balls_[k].centre).squaredNorm(), around);
      way += w * ways_[i];
      sum += w;
    }
    if (!(sum > 0)) continue;
    way /= sum;
    const Vector3f expected = dt * before_at(balls_[k].centre - way);
    const float believed = std::clamp((way - expected).norm() / noise, kAtOnce, 1.0f);
    velocities_[k] = (expected + believed * (way - expected)) / dt;
  }
}

void SurfaceMotion::carry(double seconds, std::vector<ObjectBall>& balls) const {
  balls.assign(balls_.begin(), balls_.end());
  const auto s = static_cast<float>(settings_.fades * (1 - std::exp(-seconds / settings_.fades)));
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const Vector3f way = s * velocities_[k];
    balls[k].point += way;
    balls[k].centre += way;
  }
}

}  // namespace palpable
