/// @file
/// Obstacles that a function tells, and a ball as what touches, exactly.
#pragma once

#include "palpable/common/contact/obstacles.h"

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>

namespace palpable::test {

/// The function tells the gap of a place; false: nothing is within kGapReach.
class GapFunction : public Obstacles {
 public:
  using Tell = std::function<bool(const Eigen::Vector3f& place, SurfaceGap& gap)>;
  using Near = std::function<bool(const Eigen::Vector3f& place, float reach)>;
  /// @param near  agrees with `tell`; without one what is told decides
  template <class Function>
  requires std::is_invocable_r_v<bool, Function, const Eigen::Vector3f&, SurfaceGap&> GapFunction(
      Function tell, Near near = {})
      : tell_(std::move(tell)), near_(std::move(near)) {}

  bool operator()(const Eigen::Vector3f& place, SurfaceGap& gap) const { return tell_(place, gap); }

  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override {
    for (std::size_t k = 0; k < places.size(); ++k) {
      gaps[k] = {};
      if (!tell_(places[k], gaps[k])) gaps[k] = {};
    }
  }
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override {
    if (near_) return near_(place, reach);
    SurfaceGap gap;
    return !(reach < kGapReach) || (tell_(place, gap) && !(gap.distance > reach));
  }

 private:
  Tell tell_;
  Near near_;
};

/// @param centre, radius  m
/// @param reach           m: nothing is told farther from it, nor in its very middle
inline GapFunction gap_to_ball(const Eigen::Vector3f& centre, float radius,
                               float reach = kGapReach) {
  return GapFunction([=](const Eigen::Vector3f& x, SurfaceGap& gap) {
    const Eigen::Vector3f way = x - centre;
    const float distance = way.norm();
    gap.distance = distance - radius;
    if (!(gap.distance < reach) || distance == 0.0f) return false;
    gap.normal = way / distance;
    gap.curvature = (Eigen::Matrix3f::Identity() - gap.normal * gap.normal.transpose()) / distance;
    return true;
  });
}

/// Obstacles of which there are none.
inline GapFunction nothing_near() {
  return GapFunction([](const Eigen::Vector3f&, SurfaceGap&) { return false; });
}

}  // namespace palpable::test
