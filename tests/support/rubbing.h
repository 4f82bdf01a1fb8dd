/// @file
/// Fingers and balls that rub a body, in tests of friction.
#pragma once

#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/response/tables_body.h"
#include "tests/support/cushion_stack.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace palpable::test {

// A finger that points down, its tip below the top of the cushion by `depth`, m.
inline Capsule pointing_down(double x, double y, double depth) {
  const Eigen::Vector3d tip(x, y, kTop - depth + kFinger);
  return {tip, tip + Eigen::Vector3d(0, 0, 0.04), kFinger, kFinger};
}

// Capsules that are known from frame to frame, each as the one with its number before.
class Rubbing {
 public:
  explicit Rubbing(float friction = kFrictionOfBody) : friction_(friction) {}

  const CapsuleObstacles& at(std::vector<Capsule> capsules) {
    const std::vector<Capsule> before = std::exchange(now_, std::move(capsules));
    std::vector<int> become(before.size(), -1);
    std::iota(become.begin(),
              become.begin() + static_cast<std::ptrdiff_t>(std::min(before.size(), now_.size())),
              0);
    obstacles_.set(now_);
    obstacles_.set_friction(std::vector<float>(now_.size(), friction_), before, become);
    return obstacles_;
  }
  // One finger on a cushion.
  const CapsuleObstacles& at(double x, double y, double depth) {
    return at({pointing_down(x, y, depth)});
  }

 private:
  float friction_;
  std::vector<Capsule> now_;
  CapsuleObstacles obstacles_;
};

inline TouchSettings with_friction(double mu) {
  TouchSettings settings;
  settings.friction = mu;
  return settings;
}

}  // namespace palpable::test
