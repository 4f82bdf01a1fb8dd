/// @file
/// Which contact points of a skin are near the object in a shape of the skin, and what gap each
/// has: asked as seldom as the answer allows.
///
/// A gap is asked again only where its point has moved by more than 0.3 mm within a frame; up to
/// there its normal and curvature tell it. An object needs the more points the sharper it is
/// (point_levels.h): of a heap of points (skin_clusters.h) the coarser ones are asked first, the
/// finer ones only where something twice as sharp as those have seen would need them. Before
/// another body's skin points are 3 mm apart.
///
///   W  columns of a displacement, the vertices first     C  contact points
#pragma once

#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/skin_clusters.h"
#include "palpable/common/contact/surface_gap.h"
#include "palpable/common/contact/touch_skin.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace palpable {

/// The larger of the two curvatures of a surface, 1/m.
[[nodiscard]] float largest_curvature(const Eigen::Matrix3f& K);

/// Whether the points that are left without one are too far apart for an object there.
/// @param level    of the point, m, and `coarsest`, `finest`: point_levels()
/// @param bend     1/m, the object's largest curvature
/// @param entry    m that it may enter between two points
[[nodiscard]] bool is_point_needed(float level, float bend, float entry, float coarsest,
                                   float finest);

/// Allocates in its constructor.
class NearPoints {
 public:
  /// @param skin   outlives this
  /// @param entry  m, see TouchSettings
  NearPoints(const TouchSkin& skin, double entry);

  /// What was told of gaps before is forgotten: the object is another one.
  void start() { ++frame_; }

  /// The gaps of points, the obstacles being asked once for all of them.
  /// @param points   of which
  /// @param places   m, where each is now
  /// @param far      m: where a point is farther for sure, that it is so may be all that is told
  /// @param answers  as many, overwritten; of infinite distance where nothing is, or no number
  void find_gaps(std::span<const int> points, std::span<const Eigen::Vector3f> places,
                 const Obstacles& obstacles, float far, std::span<SurfaceGap> answers);

  /// Tells found(point, gap) the points that are nearer to the object than `band`, of those that an
  /// object as sharp needs. @param u  (3 x W) m, as TouchSkin::face_as() knows it
  template <class Found>
  void for_each(const Eigen::Matrix3Xf& u, float band, const Obstacles& obstacles,
                const Found& found) {
    for (const SkinCluster& heap : heaps_.clusters()) {
      if (is_far(heap, u, band, obstacles)) continue;
      float sharpest = kUnseen;
      for (int k = heap.first; k < heap.last; ++k) {
        const int point = heaps_.order()[static_cast<std::size_t>(k)];
        if (sharpest != kUnseen && !is_needed(point, kSharper * sharpest)) break;
        SurfaceGap seen;
        if (!is_near(point, u, band, obstacles, seen)) continue;
        const float bend = bend_of(seen);
        sharpest = std::max(sharpest, bend);
        if (is_needed(point, bend)) found(point, seen);
      }
    }
  }

 private:
  static constexpr float kSharper = 2;
  static constexpr float kUnseen = -std::numeric_limits<float>::infinity();
  // As a gap was found in this frame.
  struct Found {
    int frame = -1;
    Eigen::Vector3f place = Eigen::Vector3f::Zero();
    SurfaceGap gap;  // infinite: nothing
  };
  // 1/m: of another body's skin one for all places, so that points do not come and go as they
  // slide over its triangles.
  [[nodiscard]] float bend_of(const SurfaceGap& seen) const;
  [[nodiscard]] bool is_needed(int point, float bend) const;
  [[nodiscard]] bool is_far(const SkinCluster& heap, const Eigen::Matrix3Xf& u, float band,
                            const Obstacles& obstacles) const;
  bool is_near(int point, const Eigen::Matrix3Xf& u, float band, const Obstacles& obstacles,
               SurfaceGap& seen);

  const TouchSkin& skin_;
  float entry_;
  SkinClusters heaps_;
  std::vector<Found> found_;  // (C)
  int frame_ = 0;
  std::vector<Eigen::Vector3f> asked_;  // places of one call,
  std::vector<SurfaceGap> told_;        // their gaps,
  std::vector<int> of_asked_;           // and points
};

}  // namespace palpable
