/// @file
/// Search for the contact points of a body that are near an obstacle, in the body's shape, and for
/// the gap of each, with as few queries of the obstacles as possible.
///
/// A gap is queried again only if its point has moved by more than 0.3 mm within a frame; up to
/// there its normal and curvature give it. A sharper obstacle needs more points (point_levels.h).
/// Within a cluster of points (skin_clusters.h) the coarsest are queried first, and
/// finer ones only while an obstacle twice as sharp as the sharpest found there would need them.
/// Neighbouring clusters form blocks; a block far from all obstacles is skipped with one query.
///
///   C  contact points
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/skin_clusters.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace palpable {

/// The larger of the two curvatures of a surface, 1/m.
[[nodiscard]] float largest_curvature(const Eigen::Matrix3f& K);

/// Whether an obstacle could enter too deep between the other points if this one were left out.
/// @param level    of the point, m, and `coarsest`, `finest`: point_levels()
/// @param bend     1/m, the obstacle's largest curvature
/// @param entry    m that it may enter between two points
[[nodiscard]] bool is_point_needed(float level, float bend, float entry, float coarsest,
                                   float finest);

/// Allocates in its constructor.
class NearPoints {
 public:
  /// @param body  outlives this
  explicit NearPoints(ContactBody& body);

  /// Forgets the gaps: a frame with other obstacles begins.
  void start() { ++frame_; }

  /// The gaps of points, with one query of the obstacles.
  /// @param points     indices of contact points
  /// @param positions  m, of each now
  /// @param far        m: for a point that is certainly farther, a lower bound may be returned
  /// @param gaps       as many, overwritten; an infinite distance where there is no obstacle, or
  ///                   where what was returned is not finite
  void find_gaps(std::span<const int> points, std::span<const Eigen::Vector3f> positions,
                 const Obstacles& obstacles, float far, std::span<SurfaceGap> gaps);

  /// Calls found(point, gap) for the contact points of the shape that are nearer than `band` (m) to
  /// an obstacle and that an obstacle of its curvature needs.
  template <class Found>
  void for_each(float band, const Obstacles& obstacles, const Found& found) {
    for (const Block& block : blocks_) {
      if (is_far(block, band, obstacles)) continue;
      for (int k = block.first; k < block.last; ++k) {
        search(clusters_[static_cast<std::size_t>(k)], band, obstacles, found);
      }
    }
  }
  /// Whether an obstacle that may enter by `entry` (m) between two points needs this one.
  [[nodiscard]] bool is_needed(int point, const Eigen::Matrix3f& curvature, float entry) const {
    return is_point_needed(points_.levels[static_cast<std::size_t>(point)],
                           largest_curvature(curvature), entry, points_.coarsest, points_.finest);
  }
  /// Whether a contact point of the shape is nearer than `band` (m) to an obstacle; then its gap.
  bool is_near(int point, float band, const Obstacles& obstacles, SurfaceGap& gap);
  /// m, how deep the deepest contact point of the shape is inside an obstacle; 0: none is. Unlike
  /// for_each(), which searches the points that a solution needs, it leaves no point out. Costs one
  /// query for a block or cluster that is far, and Obstacles::depth_at() of each point near or
  /// inside an obstacle.
  [[nodiscard]] float depth_of_points(const Obstacles& obstacles) const;
  /// The same of the vertices that the support holds.
  [[nodiscard]] float depth_of_held(const Obstacles& obstacles) const;
  /// Vertices in the middles of the clusters of contact points of which one may be nearer than
  /// `reach` (m) to an obstacle. @param vertices  overwritten
  void find_near_vertices(float reach, const Obstacles& obstacles,
                          std::vector<int>& vertices) const;
  /// Of all clusters.
  void find_all_vertices(std::vector<int>& vertices) const;
  [[nodiscard]] std::size_t cluster_count() const { return clusters_.size(); }
  /// The contact points that are searched on the skins of other bodies.
  [[nodiscard]] std::span<const int> between() const { return between_; }

 private:
  static constexpr float kSharper = 2;  // finer points are queried for this ratio of sharpness
  static constexpr float kUnseen = -std::numeric_limits<float>::infinity();
  // The last gap of a point.
  struct Known {
    int frame = -1;
    Eigen::Vector3f position = Eigen::Vector3f::Zero();
    SurfaceGap gap;  // infinite: no obstacle
  };
  struct Block {
    int first = 0, last = 0;  // clusters_[first] .. [last - 1]
    float radius = 0;         // m, at rest: the largest of them
  };
  template <class Found>
  void search(const SkinCluster& cluster, float band, const Obstacles& obstacles,
              const Found& found) {
    if (is_far(cluster, band, obstacles)) return;
    float sharpest = kUnseen;
    for (int k = cluster.first; k < cluster.last; ++k) {
      const int point = points_.clusters->order()[static_cast<std::size_t>(k)];
      if (sharpest != kUnseen && !is_needed(point, kSharper * sharpest)) break;
      SurfaceGap gap;
      if (!is_near(point, band, obstacles, gap)) continue;
      const float bend = largest_curvature(gap.curvature);
      sharpest = std::max(sharpest, bend);
      if (is_needed(point, bend)) found(point, gap);
    }
  }
  void arrange_clusters(std::span<const SkinCluster> clusters);
  [[nodiscard]] bool is_needed(int point, float bend) const;
  [[nodiscard]] bool is_far(const Block& block, float band, const Obstacles& obstacles) const;
  [[nodiscard]] bool is_far(const SkinCluster& cluster, float band,
                            const Obstacles& obstacles) const;

  ContactBody& body_;
  SkinPointSet points_;
  float entry_;
  std::vector<SkinCluster> clusters_;  // along a space-filling curve
  std::vector<Block> blocks_;
  std::vector<int> between_;
  Eigen::AlignedBox3f held_;  // around the vertices that the support holds; empty: none
  std::vector<Known> known_;  // (C)
  int frame_ = 0;
  std::vector<Eigen::Vector3f> queried_;  // positions of one query,
  std::vector<SurfaceGap> returned_;      // their gaps,
  std::vector<int> of_queried_;           // and points
};

}  // namespace palpable
