#include "palpable/desk/score/pop.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/score/deepest_sample.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace palpable {
namespace {

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

// m_n (pop.h); nothing when the two frames cannot be compared.
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

}  // namespace

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

}  // namespace palpable
