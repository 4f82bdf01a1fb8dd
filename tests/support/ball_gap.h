/// @file
/// Obstacles given by a function of the gap, and an exact ball as an obstacle.
#pragma once

#include "palpable/common/contact/obstacles.h"

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>

namespace palpable::test {

/// Obstacles whose gap at a position is computed by a function, which returns false if nothing is
/// within kGapReach.
class GapFunction : public Obstacles {
 public:
  using Query = std::function<bool(const Eigen::Vector3f& place, SurfaceGap& gap)>;
  using Near = std::function<bool(const Eigen::Vector3f& place, float reach)>;
  /// @param near  must agree with `query`; if empty, `query` is used
  template <class Function>
  requires std::is_invocable_r_v<bool, Function, const Eigen::Vector3f&, SurfaceGap&> GapFunction(
      Function query, Near near = {})
      : query_(std::move(query)), near_(std::move(near)) {}

  bool operator()(const Eigen::Vector3f& place, SurfaceGap& gap) const {
    return query_(place, gap);
  }

  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override {
    for (std::size_t k = 0; k < places.size(); ++k) {
      gaps[k] = {};
      if (!query_(places[k], gaps[k])) gaps[k] = {};
    }
  }
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override {
    if (near_) return near_(place, reach);
    SurfaceGap gap;
    return !(reach < kGapReach) || (query_(place, gap) && !(gap.distance > reach));
  }

 private:
  Query query_;
  Near near_;
};

/// @param centre, radius  m
/// @param reach           m; beyond it, and at the exact centre, the function returns false
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

/// No obstacles.
inline GapFunction nothing_near() {
  return GapFunction([](const Eigen::Vector3f&, SurfaceGap&) { return false; });
}

}  // namespace palpable::test
