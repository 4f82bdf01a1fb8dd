#include "palpable/common/contact/capsule_obstacles.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

bool is_same_capsule(const Capsule& a, const Capsule& b) {
  return a.a == b.a && a.b == b.b && a.ra == b.ra && a.rb == b.rb;
}

// Where a point fixed to a capsule is after the capsule has moved.
Vector3f moved_with(const Capsule& from, const Capsule& to, const Vector3f& x) {
  if (is_same_capsule(from, to)) return x;
  const Vector3d old_axis = from.b - from.a, axis = to.b - to.a;
  const Vector3d arm = x.cast<double>() - from.a;
  const bool is_ball = !(old_axis.squaredNorm() > 0) || !(axis.squaredNorm() > 0);
  if (is_ball || old_axis == axis) return (to.a + arm).cast<float>();
  const auto turn = Eigen::Quaterniond::FromTwoVectors(old_axis, axis);
  return (to.a + turn * arm).cast<float>();
}

}  // namespace

void CapsuleObstacles::set(std::span<const Capsule> capsules, std::span<const int> things) {
  PALPABLE_EXPECT(things.empty() || things.size() == capsules.size(), "a thing for each capsule");
  fields_.clear();
  things_.assign(things.begin(), things.end());
  parts_.clear();
  boxes_.clear();
  box_.setEmpty();
  friction_.clear();
  for (const Capsule& capsule : capsules) {
    fields_.emplace_back(capsule);
    parts_.push_back({capsule.a.cast<float>(), capsule.b.cast<float>(),
                      static_cast<float>(capsule.ra), static_cast<float>(capsule.rb)});
    boxes_.push_back(box_of(capsule).cast<float>());
    box_.extend(boxes_.back());
  }
}

void CapsuleObstacles::set_friction(std::span<const float> friction,
                                    std::span<const Capsule> before, std::span<const int> now) {
  set_motion(friction, before, now);
  make_room_on_the_way();
}

void CapsuleObstacles::set_motion(std::span<const float> friction, std::span<const Capsule> before,
                                  std::span<const int> now) {
  PALPABLE_EXPECT(friction.size() == fields_.size() && before.size() == now.size(),
                  "a friction for each capsule, a successor for each of before");
  friction_.assign(friction.begin(), friction.end());
  capsules_.clear();
  for (const CapsuleField& field : fields_) capsules_.push_back(field.capsule());
  before_.assign(before.begin(), before.end());
  now_of_.assign(now.begin(), now.end());
  before_of_.assign(capsules_.size(), -1);
  for (std::size_t k = 0; k < now_of_.size(); ++k) {
    if (now_of_[k] >= 0) before_of_[static_cast<std::size_t>(now_of_[k])] = static_cast<int>(k);
  }
}

// Reserves what on_the_way() needs, so that a frame that is divided allocates nothing.
void CapsuleObstacles::make_room_on_the_way() {
  if (!on_the_way_) on_the_way_ = std::make_unique<CapsuleObstacles>();
  CapsuleObstacles& other = *on_the_way_;
  between_.reserve(capsules_.capacity());
  other.fields_.reserve(fields_.capacity());
  other.things_.reserve(things_.capacity());
  other.parts_.reserve(parts_.capacity());
  other.boxes_.reserve(boxes_.capacity());
  other.friction_.reserve(friction_.capacity());
  for (auto* list : {&other.capsules_, &other.before_}) {
    list->reserve(std::max(capsules_.capacity(), before_.capacity()));
  }
  for (auto* list : {&other.now_of_, &other.before_of_}) {
    list->reserve(std::max(now_of_.capacity(), before_of_.capacity()));
  }
}

const Obstacles* CapsuleObstacles::on_the_way(float done) const {
  if (friction_.empty() || !on_the_way_) return nullptr;
  between_.clear();
  for (std::size_t k = 0; k < capsules_.size(); ++k) {
    const int before = before_of_[k];
    between_.push_back(before < 0 ? capsules_[k]
                                  : interpolated(before_[static_cast<std::size_t>(before)],
                                                 capsules_[k], static_cast<double>(done)));
  }
  on_the_way_->set(between_, things_);
  on_the_way_->set_motion(friction_, before_, now_of_);
  return on_the_way_.get();
}

float CapsuleObstacles::largest_way() const {
  if (fields_.empty()) return 0;
  if (friction_.empty()) return Obstacles::largest_way();
  double largest = 0;
  for (std::size_t k = 0; k < capsules_.size(); ++k) {
    if (before_of_[k] < 0) continue;
    const Capsule &now = capsules_[k], &before = before_[static_cast<std::size_t>(before_of_[k])];
    const double grown = std::max(std::abs(now.ra - before.ra), std::abs(now.rb - before.rb));
    largest =
        std::max({largest, (now.a - before.a).norm() + grown, (now.b - before.b).norm() + grown});
  }
  return static_cast<float>(largest);
}

float CapsuleObstacles::largest_friction(float of_body) const {
  float largest = 0;
  for (const float one : friction_) largest = std::max(largest, friction_coefficient(one, of_body));
  return largest;
}

std::optional<MaterialPoint> CapsuleObstacles::carried(const MaterialPoint& before) const {
  const auto part = static_cast<std::size_t>(before.part);
  if (friction_.empty() || before.part < 0 || part >= now_of_.size()) return std::nullopt;
  const int now = now_of_[part];
  if (now < 0) return std::nullopt;
  return MaterialPoint{
      now, moved_with(before_[part], capsules_[static_cast<std::size_t>(now)], before.place)};
}

std::optional<Vector3f> CapsuleObstacles::way_of(const MaterialPoint& now) const {
  const auto part = static_cast<std::size_t>(now.part);
  if (friction_.empty() || now.part < 0 || part >= before_of_.size()) return std::nullopt;
  const int before = before_of_[part];
  if (before < 0) return std::nullopt;
  const Capsule& from = before_[static_cast<std::size_t>(before)];
  return Vector3f(now.place - moved_with(capsules_[part], from, now.place));
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
  if (!friction_.empty()) {
    gap.part = static_cast<int>(found);
    gap.friction = friction_[found];
  }
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
