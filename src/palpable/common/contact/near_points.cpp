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
      found_(skin.points().size()) {}

bool NearPoints::gap_at(int point, const Vector3f& x, const GapQuery& gap, float far,
                        SurfaceGap& answer) {
  Found& last = found_[static_cast<std::size_t>(point)];
  const float moved = (x - last.place).norm();
  const bool is_same_place = last.frame == frame_ && moved < kSameGap;
  // A distance falls by no more than its place has moved.
  const bool stays_far =
      last.frame == frame_ && last.near && last.gap.distance - moved > far && !is_same_place;
  if (!is_same_place && !stays_far) {
    last.frame = frame_;
    last.place = x;
    last.near = gap(x, last.gap) && std::isfinite(last.gap.distance) &&
                last.gap.normal.allFinite() && last.gap.curvature.allFinite();
  }
  if (!last.near) return false;
  const Vector3f way = x - last.place;
  const GapBeside beside = gap_beside(last.gap.normal, last.gap.curvature, way);
  answer = last.gap;
  answer.distance += beside.farther;
  // Over a long way the curvature of a hollow would tell of a surface that is not there.
  if (stays_far) answer.distance = std::max(answer.distance, last.gap.distance - moved);
  answer.normal = beside.normal;
  return true;
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
                        const GapQuery& gap, const NearQuery& near) const {
  const Vector3f middle = skin_.rest().col(heap.vertex) + u.col(heap.vertex);
  const float reach = band + kStretch * heap.radius;
  if (near) return !near(middle, reach);
  SurfaceGap seen;
  return !gap(middle, seen) || !(seen.distance <= reach);
}

bool NearPoints::is_near(int point, const Matrix3Xf& u, float band, const GapQuery& gap,
                         const NearQuery& near, SurfaceGap& seen) {
  const Vector3f x = skin_.places().col(point) + skin_.moved(static_cast<std::size_t>(point), u);
  if (near && !near(x, band)) return false;
  return gap_at(point, x, gap, band, seen) && seen.distance <= band;
}

}  // namespace palpable
