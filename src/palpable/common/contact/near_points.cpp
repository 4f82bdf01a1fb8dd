#include "palpable/common/contact/near_points.h"

#include "palpable/common/geometry/element_order.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace palpable {
namespace {

using Eigen::Vector3f;

// Largest distance of a cluster's points from its middle, ratio to that at rest: the skin may be
// stretched.
constexpr float kStretch = 1.3f;
// m from the position where a gap was queried, up to which its normal and curvature give it. The
// error is of the third order: 2e-6 m at the tip of a pencil.
constexpr float kSameGap = 0.0003f;
constexpr std::size_t kClustersOfBlock = 16;

}  // namespace

float largest_curvature(const Eigen::Matrix3f& K) {
  const float trace = K.trace();
  const float apart = 2 * K.squaredNorm() - trace * trace;
  return 0.5f * (trace + std::sqrt(std::max(0.0f, apart)));
}

bool is_point_needed(float level, float bend, float entry, float coarsest, float finest) {
  // Where each point has another one within s, a ball of radius 1/bend enters by about s^2 bend /
  // 4.
  const float enough = bend > 0 ? std::min(coarsest, std::sqrt(4 * entry / bend)) : coarsest;
  return level > 0 ? level * std::numbers::sqrt2_v<float> > enough : enough < finest;
}

NearPoints::NearPoints(ContactBody& body)
    : body_(body),
      points_(body.contact_points()),
      entry_(static_cast<float>(body.limits().entry)),
      known_(points_.points.size()) {
  queried_.reserve(known_.size());
  returned_.reserve(known_.size());
  of_queried_.reserve(known_.size());
  for (std::size_t p = 0; p < points_.points.size(); ++p) {
    // The points of one level coarser than `between` are included.
    if (points_.levels[p] * std::numbers::sqrt2_v < float >> points_.between) {
      between_.push_back(static_cast<int>(p));
    }
  }
  if (points_.held != nullptr) {
    for (const auto& x : points_.held->colwise()) held_.extend(Vector3f(x));
  }
  if (points_.clusters != nullptr) arrange_clusters(points_.clusters->clusters());
}

// Orders the clusters along a curve and divides them into blocks of neighbouring ones.
void NearPoints::arrange_clusters(std::span<const SkinCluster> clusters) {
  if (clusters.empty()) return;
  Eigen::Matrix3Xd middles(3, std::ssize(clusters));
  for (Eigen::Index k = 0; k < middles.cols(); ++k) {
    middles.col(k) =
        body_.shape_at_vertex(clusters[static_cast<std::size_t>(k)].vertex).cast<double>();
  }
  for (const int k : order_along_curve(middles)) {
    if (clusters_.size() % kClustersOfBlock == 0) {
      const int at = static_cast<int>(clusters_.size());
      blocks_.push_back({at, at, 0});
    }
    clusters_.push_back(clusters[static_cast<std::size_t>(k)]);
    blocks_.back().last = static_cast<int>(clusters_.size());
    blocks_.back().radius = std::max(blocks_.back().radius, clusters_.back().radius);
  }
}

void NearPoints::find_gaps(std::span<const int> points, std::span<const Vector3f> positions,
                           const Obstacles& obstacles, float far, std::span<SurfaceGap> gaps) {
  queried_.clear();
  of_queried_.clear();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Known& last = known_[static_cast<std::size_t>(points[k])];
    const float moved = (positions[k] - last.position).norm();
    // A distance decreases by no more than its point has moved.
    const bool stays_far = std::isfinite(last.gap.distance) && last.gap.distance - moved > far;
    if (last.frame == frame_ && (moved < kSameGap || stays_far)) continue;
    queried_.push_back(positions[k]);
    of_queried_.push_back(points[k]);
  }
  returned_.resize(queried_.size());
  if (!queried_.empty()) obstacles.find_gaps(queried_, returned_);
  for (std::size_t k = 0; k < queried_.size(); ++k) {
    Known& known = known_[static_cast<std::size_t>(of_queried_[k])];
    known.frame = frame_;
    known.position = queried_[k];
    known.gap = returned_[k].is_known() ? returned_[k] : SurfaceGap();
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Known& last = known_[static_cast<std::size_t>(points[k])];
    SurfaceGap& gap = gaps[k];
    gap = last.gap;
    if (!std::isfinite(last.gap.distance)) continue;
    const Vector3f way = positions[k] - last.position;
    const GapBeside beside = gap_beside(last.gap.normal, last.gap.curvature, way);
    gap.distance += beside.farther;
    gap.normal = beside.normal;
    // Far away the curvature of a concave obstacle would give a surface that is not there.
    const float moved = way.norm();
    if (moved >= kSameGap) gap.distance = std::max(gap.distance, last.gap.distance - moved);
  }
}

bool NearPoints::is_needed(int point, float bend) const {
  return is_point_needed(points_.levels[static_cast<std::size_t>(point)], bend, entry_,
                         points_.coarsest, points_.finest);
}

bool NearPoints::is_far(const Block& block, float band, const Obstacles& obstacles) const {
  Eigen::AlignedBox3f middles;
  for (int k = block.first; k < block.last; ++k) {
    middles.extend(body_.shape_at_vertex(clusters_[static_cast<std::size_t>(k)].vertex));
  }
  const float around = 0.5f * middles.diagonal().norm() + kStretch * block.radius;
  return !obstacles.may_be_within(middles.center(), band + around);
}

bool NearPoints::is_far(const SkinCluster& cluster, float band, const Obstacles& obstacles) const {
  return !obstacles.may_be_within(body_.shape_at_vertex(cluster.vertex),
                                  band + kStretch * cluster.radius);
}

void NearPoints::find_near_vertices(float reach, const Obstacles& obstacles,
                                    std::vector<int>& vertices) const {
  vertices.clear();
  for (const Block& block : blocks_) {
    if (is_far(block, reach, obstacles)) continue;
    for (int k = block.first; k < block.last; ++k) {
      const SkinCluster& cluster = clusters_[static_cast<std::size_t>(k)];
      if (!is_far(cluster, reach, obstacles)) vertices.push_back(cluster.vertex);
    }
  }
}

void NearPoints::find_all_vertices(std::vector<int>& vertices) const {
  vertices.clear();
  for (const SkinCluster& cluster : clusters_) vertices.push_back(cluster.vertex);
}

float NearPoints::depth_of_points(const Obstacles& obstacles) const {
  float deepest = 0;
  for (const Block& block : blocks_) {
    if (is_far(block, 0, obstacles)) continue;
    for (int c = block.first; c < block.last; ++c) {
      const SkinCluster& cluster = clusters_[static_cast<std::size_t>(c)];
      // No point of the cluster is deeper than its middle by more than this.
      const float around = kStretch * cluster.radius;
      const Vector3f middle = body_.shape_at_vertex(cluster.vertex);
      const bool may_be_deeper = around > deepest
                                     ? obstacles.may_be_within(middle, around - deepest)
                                     : obstacles.depth_at(middle) + around > deepest;
      if (!may_be_deeper) continue;
      for (int k = cluster.first; k < cluster.last; ++k) {
        const int point = points_.clusters->order()[static_cast<std::size_t>(k)];
        deepest = std::max(deepest, obstacles.depth_at(body_.shape_at(point)));
      }
    }
  }
  return deepest;
}

float NearPoints::depth_of_held(const Obstacles& obstacles) const {
  if (held_.isEmpty()) return 0;
  if (!obstacles.may_be_within(held_.center(), 0.5f * held_.diagonal().norm())) return 0;
  float deepest = 0;
  for (const auto& x : points_.held->colwise()) {
    deepest = std::max(deepest, obstacles.depth_at(Vector3f(x)));
  }
  return deepest;
}

bool NearPoints::is_near(int point, float band, const Obstacles& obstacles, SurfaceGap& gap) {
  const Vector3f x = body_.shape_at(point);
  if (!obstacles.may_be_within(x, band)) return false;
  find_gaps({&point, 1}, {&x, 1}, obstacles, band, {&gap, 1});
  return gap.distance <= band;
}

}  // namespace palpable
