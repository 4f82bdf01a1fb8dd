#include "palpable/common/contact/capsule_obstacles.h"

#include <algorithm>
#include <cstddef>

namespace palpable {

using Eigen::Vector3f;

void CapsuleObstacles::set(std::span<const Capsule> capsules) {
  fields_.clear();
  boxes_.clear();
  box_.setEmpty();
  for (const Capsule& capsule : capsules) {
    fields_.emplace_back(capsule);
    boxes_.push_back(box_of(capsule).cast<float>());
    box_.extend(boxes_.back());
  }
}

void CapsuleObstacles::find_gaps(std::span<const Vector3f> places,
                                 std::span<SurfaceGap> gaps) const {
  for (std::size_t k = 0; k < places.size(); ++k) gaps[k] = gap_of(places[k]);
}

SurfaceGap CapsuleObstacles::gap_of(const Vector3f& place) const {
  SurfaceGap gap;
  const Eigen::Vector3d x = place.cast<double>();
  double nearest = static_cast<double>(kGapReach);
  const CapsuleField* found = nullptr;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    if (!(boxes_[k].squaredExteriorDistance(place) < kGapReach * kGapReach)) continue;
    const double distance = fields_[k].distance(x);
    if (!(distance < nearest)) continue;
    nearest = distance;
    found = &fields_[k];
  }
  if (found == nullptr) return gap;
  gap.distance = static_cast<float>(nearest);
  gap.normal = found->normal(x).cast<float>();
  gap.curvature = found->curvature(x).cast<float>();
  return gap;
}

bool CapsuleObstacles::may_be_within(const Vector3f& place, float reach) const {
  if (!(box_.squaredExteriorDistance(place) < reach * reach)) return false;
  return std::any_of(boxes_.begin(), boxes_.end(), [&](const Eigen::AlignedBox3f& box) {
    return box.squaredExteriorDistance(place) < reach * reach;
  });
}

}  // namespace palpable
