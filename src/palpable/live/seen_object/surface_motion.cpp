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

// The largest number of balls for which a displacement is computed: all 100 of a finger, every
// sixth of a palm's 1,500. The others interpolate.
constexpr std::size_t kMostSampled = 256;

constexpr double kLongest = 0.2;  // s, the longest time between two frames that are compared

// m: a sample that lies deeper inside of another ball than this is not on the union's surface.
constexpr float kInside = 0.0003f;
// Cosine of the angle between a sample's normal and the direction to the camera. Samples below it
// lie on the assumed far side, which jumps between frames, and are left out.
constexpr float kAway = -0.3f;
constexpr int kSteps = 3;  // of Newton's method
// Weight e of the regularisation, as a ratio to the trace of the samples' normal equations.
constexpr float kFirm = 0.002f;
// m: a sample with a residual of this size has weight 1/2.
constexpr float kOff = 0.001f;
constexpr float kAtOnce = 0.5f;  // least share of a change that a velocity follows at once

// The directions of samples: six along the axes, eight between them.
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

// The weight k: 1 at distance 0, 0 from `reach` on. @param squared  m^2, of the distance
float nearness(float squared, float reach) {
  const float left = std::max(1 - squared / (reach * reach), 0.0f);
  return left * left;
}

// The displacement that solves A w = b, and is `usual` where A does not determine it.
Vector3f way_of(const Matrix3f& A, const Vector3f& b, const Vector3f& usual) {
  const float firm = kFirm * A.trace() + 1e-6f;
  return (A + firm * Matrix3f::Identity()).ldlt().solve(b + firm * usual);
}

// Whether A determines more than half of the displacement in each direction, in way_of().
bool is_determined(const Matrix3f& A) {
  Eigen::SelfAdjointEigenSolver<Matrix3f> solver;
  solver.computeDirect(A, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] > kFirm * A.trace() + 1e-6f;
}

}  // namespace

SurfaceMotion::SurfaceMotion(const SurfaceMotionSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(
      settings.around > 0 && settings.noise > 0 && settings.reach > 0 && settings.fades > 0,
      "lengths and times are above 0");
  for (auto* balls : {&now_, &before_}) balls->reserve(kMovingBallRoom);
  for (auto* vectors : {&velocities_, &velocities_before_}) vectors->reserve(kMovingBallRoom);
  balls_.reserve(kMovingBallRoom);
  bare_.reserve(kMovingBallRoom);
  for (auto* things : {&things_, &bare_things_}) things->reserve(kMovingBallRoom);
  measured_.reserve(kMovingBallRoom);
  ways_.reserve(kMostSampled);
  of_things_.reserve(kMostSampled);
  means_.reserve(kMostSampled);
  equations_.reserve(kMostSampled);
  samples_.reserve(kMostSampled * kBallDirections.size());
}

void SurfaceMotion::add(std::span<const ObjectBall> balls, const Vector3f& camera, double time,
                        std::span<const int> things) {
  PALPABLE_EXPECT(things.empty() || things.size() == balls.size(), "the thing of each ball");
  std::swap(now_, before_);
  velocities_before_.clear();
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    if (balls_[k].unseen_for == 0) velocities_before_.push_back(velocities_[k]);
  }
  balls_.assign(balls.begin(), balls.end());
  things_.assign(balls.size(), 0);
  std::copy(things.begin(), things.end(), things_.begin());
  bare_.clear();
  bare_things_.clear();
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    if (balls_[k].unseen_for > 0) continue;
    bare_.push_back({balls_[k].centre, balls_[k].radius});
    bare_things_.push_back(things_[k]);
  }
  now_.build(bare_);
  velocities_.assign(balls_.size(), Vector3f::Zero());
  measured_.assign(balls_.size(), {});
  interval_ = time_ ? time - *time_ : 0;
  time_ = time;
  if (!(interval_ > 0) || interval_ > kLongest) interval_ = 0;
  if (interval_ == 0 || bare_.empty() || before_.balls().empty()) return;
  const auto count = static_cast<std::size_t>(*std::max_element(things_.begin(), things_.end()));
  of_things_.assign(count + 1, {});
  means_.assign(count + 1, Vector3f::Zero());
  find_samples(camera);
  solve();
}

// The velocity (m/s) of the ball nearest to a position in the previous frame; 0 without one.
Vector3f SurfaceMotion::velocity_before_at(const Vector3f& position) const {
  const auto found = before_.nearest(position, static_cast<float>(settings_.reach));
  return found ? velocities_before_[static_cast<std::size_t>(found->ball)] : Vector3f::Zero();
}

// Chooses balls, and sample points on their visible side.
void SurfaceMotion::find_samples(const Vector3f& camera) {
  samples_.clear();
  equations_.clear();
  const std::size_t stride = (bare_.size() + kMostSampled - 1) / kMostSampled;
  for (std::size_t k = 0; k < bare_.size(); k += stride) {
    const Ball& ball = bare_[k];
    const Vector3f to_camera = (camera - ball.centre).normalized();
    const int of = static_cast<int>(equations_.size());
    equations_.push_back({.centre = ball.centre, .thing = bare_things_[k]});
    for (const Vector3f& n : kBallDirections) {
      if (n.dot(to_camera) < kAway) continue;
      const Vector3f at = ball.centre + ball.radius * n;
      const auto nearest = now_.nearest(at, kInside);
      if (nearest && nearest->distance < -kInside) continue;
      samples_.push_back({at, n, of});
    }
  }
}

void SurfaceMotion::solve() {
  // Starts from displacement 0, not from the expected one: if that were wrong, all samples would
  // have large residuals and small weights.
  ways_.assign(equations_.size(), Vector3f::Zero());
  for (int step = 0; step < kSteps; ++step) {
    solve_step(step);
    find_means();
    const auto around = static_cast<float>(settings_.around);
    for (std::size_t i = 0; i < equations_.size(); ++i) {
      BallEquations& at = equations_[i];
      Matrix3f Ai = Matrix3f::Zero();
      Vector3f bi = Vector3f::Zero();
      for (const BallEquations& of_ball : equations_) {
        if (of_ball.thing != at.thing) continue;
        const float k = nearness((of_ball.centre - at.centre).squaredNorm(), around);
        if (k > 0) Ai += k * of_ball.A, bi += k * of_ball.b;
      }
      ways_[i] = way_of(Ai, bi, means_[static_cast<std::size_t>(at.thing)]);
      if (step == kSteps - 1) at.is_own = is_determined(Ai);
    }
  }
  find_velocities();
}

// Sums the normal equations of the samples on each ball, at the present displacements.
void SurfaceMotion::solve_step(int step) {
  const auto reach = static_cast<float>(settings_.reach);
  for (BallEquations& of_ball : equations_) of_ball.A.setZero(), of_ball.b.setZero();
  for (const Sample& sample : samples_) {
    const Vector3f& way = ways_[static_cast<std::size_t>(sample.of)];
    const auto then = before_.nearest(sample.at - way, reach);
    if (!then || then->distance < -reach) continue;
    const float off = then->distance;
    const float weight = step == 0 ? 1 : 1 / (1 + off * off / (kOff * kOff));
    BallEquations& of_ball = equations_[static_cast<std::size_t>(sample.of)];
    const Vector3f n = weight * sample.normal;
    of_ball.A += n * sample.normal.transpose();
    of_ball.b += n * (off + sample.normal.dot(way));
  }
}

// The displacement of all balls of each thing together.
void SurfaceMotion::find_means() {
  for (BallEquations& thing : of_things_) thing.A.setZero(), thing.b.setZero();
  for (const BallEquations& of_ball : equations_) {
    BallEquations& thing = of_things_[static_cast<std::size_t>(of_ball.thing)];
    thing.A += of_ball.A, thing.b += of_ball.b;
  }
  for (std::size_t t = 0; t < of_things_.size(); ++t) {
    means_[t] = way_of(of_things_[t].A, of_things_[t].b, Vector3f::Zero());
  }
}

// The displacement of each ball from those that were computed around it, and its velocity.
void SurfaceMotion::find_velocities() {
  const auto dt = static_cast<float>(interval_);
  const auto around = static_cast<float>(settings_.around);
  const auto noise = static_cast<float>(settings_.noise);
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    if (balls_[k].unseen_for > 0) continue;
    Vector3f way = Vector3f::Zero();
    float sum = 0, own = 0;
    for (std::size_t i = 0; i < equations_.size(); ++i) {
      if (equations_[i].thing != things_[k]) continue;
      const float w = nearness((equations_[i].centre - balls_[k].centre).squaredNorm(), around);
      way += w * ways_[i];
      sum += w;
      if (equations_[i].is_own) own += w;
    }
    const auto thing = static_cast<std::size_t>(things_[k]);
    measured_[k] = {means_[thing], of_things_[thing].A.trace() > 0, false};
    if (!(sum > 0)) continue;
    way /= sum;
    measured_[k].way = way;
    measured_[k].is_own = own > 0.5f * sum;
    const Vector3f expected = dt * velocity_before_at(balls_[k].centre - way);
    const float believed = std::clamp((way - expected).norm() / noise, kAtOnce, 1.0f);
    velocities_[k] = (expected + believed * (way - expected)) / dt;
  }
}

void SurfaceMotion::take(std::span<const ObjectBall> balls, std::span<const Vector3f> velocities,
                         double interval) {
  PALPABLE_EXPECT(velocities.size() == balls.size(), "a velocity for each ball");
  balls_.assign(balls.begin(), balls.end());
  velocities_.assign(velocities.begin(), velocities.end());
  interval_ = interval;
}

double SurfaceMotion::reached(double seconds) const {
  return settings_.fades * (1 - std::exp(-seconds / settings_.fades));
}

void SurfaceMotion::carry(double seconds, std::vector<ObjectBall>& balls) const {
  balls.assign(balls_.begin(), balls_.end());
  const auto s = static_cast<float>(reached(seconds));
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const Vector3f way = s * velocities_[k];
    balls[k].point += way;
    balls[k].centre += way;
  }
}

}  // namespace palpable
