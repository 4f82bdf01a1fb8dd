#include "palpable/common/contact/capsule_obstacles.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cstddef>

namespace palpable {

using Eigen::Vector3f;

void CapsuleObstacles::set(std::span<const Capsule> capsules, std::span<const int> things) {
  PALPABLE_EXPECT(things.empty() || things.size() == capsules.size(), "a thing for each capsule");
  fields_.clear();
  things_.assign(things.begin(), things.end());
  parts_.clear();
  boxes_.clear();
  box_.setEmpty();
  for (const Capsule& capsule : capsules) {
    fields_.emplace_back(capsule);
    parts_.push_back({capsule.a.cast<float>(), capsule.b.cast<float>(),
                      static_cast<float>(capsule.ra), static_cast<float>(capsule.rb)});
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
  std::size_t found = fields_.size();
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    if (!(boxes_[k].squaredExteriorDistance(place) < kGapReach * kGapReach)) continue;
    const double distance = fields_[k].distance(x);
    if (!(distance < nearest)) continue;
    nearest = distance;
    found = k;
  }
  if (found == fields_.size()) return gap;
  gap.distance = static_cast<float>(nearest);
  gap.normal = fields_[found].normal(x).cast<float>();
  gap.curvature = fields_[found].curvature(x).cast<float>();
  if (!things_.empty()) gap.thing = things_[found];
  return gap;
}

bool CapsuleObstacles::may_be_within(const Vector3f& place, float reach) const {
  if (!(box_.squaredExteriorDistance(place) < reach * reach)) return false;
  return std::any_of(boxes_.begin(), boxes_.end(), [&](const Eigen::AlignedBox3f& box) {
    return box.squaredExteriorDistance(place) < reach * reach;
  });
}

float CapsuleObstacles::depth_at(const Vector3f& place) const {
  if (!box_.contains(place)) return 0;
  const Eigen::Vector3d x = place.cast<double>();
  double deepest = 0;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    if (boxes_[k].contains(place)) deepest = std::max(deepest, -fields_[k].distance(x));
  }
  return static_cast<float>(deepest);
}

void CapsuleObstacles::add_sharp_parts(const Eigen::AlignedBox3f& box, float radius,
                                       std::vector<SharpPart>& parts) const {
  if (!box_.intersects(box)) return;
  for (std::size_t k = 0; k < parts_.size() && parts.size() < parts.capacity(); ++k) {
    const SharpPart& part = parts_[k];
    if (!(std::min(part.radius_a, part.radius_b) < radius) || !boxes_[k].intersects(box)) continue;
    parts.push_back(part);
  }
}

}  // namespace palpable
