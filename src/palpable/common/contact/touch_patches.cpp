#include "palpable/common/contact/touch_patches.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Vector3f;

// m: pressed points closer than this that are pushed the same way belong to one touch.
constexpr float kOneTouch = 0.006f;
// m: farther points are not neighbours. Every position has a point of the sparsest set, that for
// flat obstacles, within half of this.
constexpr float kSparse = 0.012f;
// Largest distance of neighbours, ratio to their mean spacing: on a square grid the diagonal
// neighbour lies at 1.41.
constexpr float kNeighbours = 1.5f;

}  // namespace

TouchPatches::TouchPatches(std::size_t most) {
  points_.reserve(most);
  places_.reserve(most);
  queried_.reserve(most);
  gaps_.reserve(most);
}

void TouchPatches::find(const Obstacles* seen, std::vector<Touch>& touches) {
  touches.clear();
  places_.resize(points_.size());
  find_known(seen);
  join_neighbours();
  for (int patch = 0; patch < patches_; ++patch) touches.push_back(touch_of(patch));
  std::sort(touches.begin(), touches.end(),
            [](const Touch& a, const Touch& b) { return a.force > b.force; });
}

// Whether two points may belong to one touch, apart from their distance.
bool TouchPatches::are_alike(int i, int j) const {
  return points_[i].by == points_[j].by && places_[i].thing == places_[j].thing &&
         points_[i].force.dot(points_[j].force) > 0;
}

void TouchPatches::find_spacings() {
  const int n = static_cast<int>(points_.size());
  for (int i = 0; i < n; ++i) {
    float nearest = kSparse * kSparse;
    bool found = false;
    for (int j = 0; j < n; ++j) {
      if (j == i || !are_alike(i, j)) continue;
      const float squared = (points_[i].place - points_[j].place).squaredNorm();
      if (squared < nearest) nearest = squared, found = true;
    }
    const float own = std::sqrt(points_[i].area);
    places_[i].spacing = found ? std::max(own, std::sqrt(nearest)) : own;
  }
}

// Joins neighbours into patches, and numbers these by their first points.
void TouchPatches::join_neighbours() {
  find_spacings();
  const int n = static_cast<int>(points_.size());
  const auto root = [&](int i) {
    while (places_[i].first != i) i = places_[i].first;
    return i;
  };
  for (int i = 0; i < n; ++i) {
    places_[i].first = i;
    for (int j = 0; j < i; ++j) {
      const float spacing = 0.5f * (places_[i].spacing + places_[j].spacing);
      const float reach = std::max(kOneTouch, kNeighbours * spacing);
      const bool near = (points_[i].place - points_[j].place).squaredNorm() < reach * reach;
      if (!near || !are_alike(i, j)) continue;
      const int a = root(i), b = root(j);
      places_[std::max(a, b)].first = std::min(a, b);
    }
  }
  patches_ = 0;
  for (int i = 0; i < n; ++i) {
    const int r = root(i);
    places_[i].patch = r == i ? patches_++ : places_[r].patch;
  }
}

// Finds for each point which obstacle presses it, whether that was measured, and how long ago.
void TouchPatches::find_known(const Obstacles* seen) {
  queried_.clear();
  for (const PressedPoint& point : points_) {
    if (point.by < 0) queried_.push_back(point.place);
  }
  gaps_.resize(queried_.size());
  if (seen == nullptr) {
    std::fill(gaps_.begin(), gaps_.end(), SurfaceGap());
  } else if (!queried_.empty()) {
    seen->find_gaps(queried_, gaps_);
  }
  std::size_t next = 0;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const SurfaceGap at = points_[k].by < 0 ? gaps_[next++] : SurfaceGap();
    places_[k].known = at.known;
    places_[k].unseen_for = at.unseen_for;
    places_[k].thing = at.thing;
  }
}

Touch TouchPatches::touch_of(int patch) const {
  Touch touch;
  Vector3f force = Vector3f::Zero(), place = Vector3f::Zero(), friction = Vector3f::Zero();
  float weight = 0, assumed = 0;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (places_[k].patch != patch) continue;
    const PressedPoint& p = points_[k];
    const float w = p.force.norm();
    force += p.force;
    friction += p.friction;
    place += w * p.place;
    weight += w;
    touch.area += static_cast<double>(places_[k].spacing) * static_cast<double>(places_[k].spacing);
    touch.by = p.by;
    touch.thing = places_[k].thing;
    if (places_[k].known != Known::kMeasured) assumed += w;
    touch.unseen_for = std::max(touch.unseen_for, static_cast<double>(places_[k].unseen_for));
  }
  touch.force = static_cast<double>(force.norm());
  touch.direction = force.cast<double>().normalized();
  touch.friction = friction.cast<double>();
  if (weight > 0) {
    touch.point_in_body = (place / weight).cast<double>();
    touch.assumed = static_cast<double>(assumed / weight);
  }
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (places_[k].patch != patch) continue;
    touch.press_depth =
        std::max(touch.press_depth, points_[k].moved.cast<double>().dot(-touch.normal()));
  }
  return touch;
}

}  // namespace palpable
