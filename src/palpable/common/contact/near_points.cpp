#include "palpable/common/contact/near_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

constexpr float kClusterRadius = 0.006f;  // m
// A heap's points may lie farther from its middle than at rest, where the skin is stretched.
constexpr float kStretch = 1.3f;
// m: so far from where it was asked last a gap is told by its normal and curvature. What that
// leaves out is of the third order: 2e-6 m at a pencil's tip.
constexpr float kSameGap = 0.0003f;
constexpr float kBetweenSkins = 0.003f;  // m between points
constexpr float kRootOf2 = 1.41421356f;

}  // namespace

float largest_curvature(const Eigen::Matrix3f& K) {
  const float trace = K.trace();
  const float apart = 2 * K.squaredNorm() - trace * trace;
  return 0.5f * (trace + std::sqrt(std::max(0.0f, apart)));
}

bool is_point_needed(float level, float bend, float entry, float coarsest, float finest) {
  // Where each point has another within s the ball of radius 1/bend enters by s^2 bend / 4,
  // roughly.
  const float enough = bend > 0 ? std::min(coarsest, std::sqrt(4 * entry / bend)) : coarsest;
  return level > 0 ? level * kRootOf2 > enough : enough < finest;
}

NearPoints::NearPoints(const TouchSkin& skin, double entry)
    : skin_(skin),
      entry_(static_cast<float>(entry)),
      heaps_(skin.rest(), skin.points(), skin.places(), skin.levels(), kClusterRadius),
      found_(skin.points().size()) {
  asked_.reserve(found_.size());
  told_.reserve(found_.size());
  of_asked_.reserve(found_.size());
}

void NearPoints::find_gaps(std::span<const int> points, std::span<const Vector3f> places,
                           const Obstacles& obstacles, float far, std::span<SurfaceGap> answers) {
  asked_.clear();
  of_asked_.clear();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Found& last = found_[static_cast<std::size_t>(points[k])];
    const float moved = (places[k] - last.place).norm();
    // A distance falls by no more than its place has moved; an infinite one tells nothing of it.
    const bool stays_far = std::isfinite(last.gap.distance) && last.gap.distance - moved > far;
    if (last.frame == frame_ && (moved < kSameGap || stays_far)) continue;
    asked_.push_back(places[k]);
    of_asked_.push_back(points[k]);
  }
  told_.resize(asked_.size());
  if (!asked_.empty()) obstacles.find_gaps(asked_, told_);
  for (std::size_t k = 0; k < asked_.size(); ++k) {
    Found& found = found_[static_cast<std::size_t>(of_asked_[k])];
    found.frame = frame_;
    found.place = asked_[k];
    found.gap = told_[k].is_told() ? told_[k] : SurfaceGap();
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Found& last = found_[static_cast<std::size_t>(points[k])];
    SurfaceGap& answer = answers[k];
    answer = last.gap;
    if (!std::isfinite(last.gap.distance)) continue;
    const Vector3f way = places[k] - last.place;
    const GapBeside beside = gap_beside(last.gap.normal, last.gap.curvature, way);
    answer.distance += beside.farther;
    answer.normal = beside.normal;
    // Over a long way the curvature of a hollow would tell of a surface that is not there.
    const float moved = way.norm();
    if (moved >= kSameGap) answer.distance = std::max(answer.distance, last.gap.distance - moved);
  }
}

float NearPoints::bend_of(const SurfaceGap& seen) const {
  if (seen.on.body < 0) return largest_curvature(seen.curvature);
  return 4 * entry_ / (kBetweenSkins * kBetweenSkins);
}

bool NearPoints::is_needed(int point, float bend) const {
  return is_point_needed(skin_.levels()[static_cast<std::size_t>(point)], bend, entry_,
                         static_cast<float>(TouchSkin::kCoarsest),
                         static_cast<float>(TouchSkin::kFinest));
}

// Whether all points of a heap are farther than `band`, for sure.
bool NearPoints::is_far(const SkinCluster& heap, const Matrix3Xf& u, float band,
                        const Obstacles& obstacles) const {
  const Vector3f middle = skin_.rest().col(heap.vertex) + u.col(heap.vertex);
  return !obstacles.may_be_within(middle, band + kStretch * heap.radius);
}

bool NearPoints::is_near(int point, const Matrix3Xf& u, float band, const Obstacles& obstacles,
                         SurfaceGap& seen) {
  const Vector3f x = skin_.places().col(point) + skin_.moved(static_cast<std::size_t>(point), u);
  if (!obstacles.may_be_within(x, band)) return false;
  find_gaps({&point, 1}, {&x, 1}, obstacles, band, {&seen, 1});
  return seen.distance <= band;
}

}  // namespace palpable
