/// @file
/// The real world near a body as one camera sees it: points with normals, and a signed distance to
/// the solid that is assumed behind them (paper Sec. 3.4, the "level set" of Figs. 7 and 8).
///
/// The camera sees only the front of a hand; where its back is, is a guess. Ours: every seen point
/// y with outward normal n is the front of a ball of diameter t, the *thickness*,
///
///     object = union over seen points of  ball(centre = y - n t/2, radius = t/2)
///     phi(x) = min |x - centre| - t/2            negative inside, m
///
/// With t the width of a finger this is a whole finger, on both sides of its silhouette: what the
/// outline of a finger presses lies *beside* its seen points, never behind them. Of a flat hand it
/// is a slab. Near the seen points phi is the distance to the tangent plane, n.(x - y).
///
/// Body frame, metres. The distance is exact in a band around the surface and unknown outside.
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct SeenSurfaceSettings {
  /// N_step of Algorithm 1: every step-th pixel of every step-th row becomes a point. Larger is
  /// faster; beyond 3 mm between points a fingertip has too few of them to be believed.
  int step = 2;
  /// Half side of the window in which a normal is fitted, px. Larger is smoother; at half of a
  /// finger's width the normals of its two flanks merge.
  int normal_reach = 3;
  /// A point needs so many known pixels on its left that are no farther away, px, but never more
  /// than 0.8 thicknesses: something of a finger must be left. The strip left of a near thing is
  /// seen by the left eye alone, and a matcher gives part of it the near thing's depth. 0 for a
  /// camera that does not match a left and a right image.
  int left_margin = 0;
  double thickness = 0.016;  ///< m, t above: an adult's finger
  double band = 0.010;       ///< m, phi is exact up to here outside, and everywhere inside
  /// m at 1 m; grows as Z^2 (disparity has constant error). Neighbours that differ more in depth
  /// belong to different things; a point with a thing far behind beside it is dropped, because
  /// matching smears near things over their outline.
  double largest_jump_at_1m = 0.040;
};

/// One seen point.
struct SeenPoint {
  Eigen::Vector3f point;   ///< m, body frame
  Eigen::Vector3f normal;  ///< unit, outwards: to the camera's side
  Eigen::Vector3f centre;  ///< m, of the assumed ball
  float depth;             ///< Z of the point in the camera, m: what its noise depends on
};

/// What is nearest to a query point.
struct NearestSeen {
  float distance = 0;  ///< phi, m; negative inside
  int point = 0;       ///< index into points()
  int support = 0;     ///< how many balls contain the query: 0 outside, 1 may be a flicker
};

/// Built anew for each frame; keeps its memory, so that building allocates nothing once a frame
/// with as many points was built.
class SeenSurface {
 public:
  /// @throws ContractViolation if step or reach is below 1, or a length is not positive
  explicit SeenSurface(const SeenSurfaceSettings& settings = {});

  /// Makes points of the pixels that lie in `region_in_body` grown by the thickness and the band.
  ///
  /// @param depth   Z in m, NaN where unknown: no depth, no point. Zero, negative and infinite
  ///                values count as unknown.
  /// @param camera  of the depth image: same width and height
  void build(const DepthImage& depth, const PinholeCamera& camera, const Rigid3& body_from_camera,
             const Eigen::AlignedBox3d& region_in_body);

  /// Uses these points as they are (tests, other sensors). Points outside the grown region are left
  /// out.
  void build(std::span<const SeenPoint> points, const Eigen::AlignedBox3d& region_in_body);

  [[nodiscard]] std::span<const SeenPoint> points() const { return points_; }
  [[nodiscard]] const SeenSurfaceSettings& settings() const { return settings_; }

  /// phi at x; nothing when x is farther than the band from all balls. Looks at the points of 27
  /// cells of a grid whose cell is radius + band. Allocates nothing.
  [[nodiscard]] std::optional<NearestSeen> nearest(const Eigen::Vector3f& x) const;

  /// The same by looking at every point: what nearest() is tested against.
  [[nodiscard]] std::optional<NearestSeen> nearest_by_brute_force(const Eigen::Vector3f& x) const;

 private:
  void start(const Eigen::AlignedBox3d& region_in_body);
  void sort_into_grid();
  [[nodiscard]] Eigen::Vector3i cell_of(const Eigen::Vector3f& x) const;
  [[nodiscard]] std::size_t cell_index(const Eigen::Vector3i& cell) const;

  SeenSurfaceSettings settings_;
  Eigen::AlignedBox3f region_;  // grown
  Eigen::Vector3i cells_ = Eigen::Vector3i::Zero();
  float cell_size_ = 0;
  std::vector<SeenPoint> points_;
  std::vector<SeenPoint> unsorted_;
  std::vector<int> first_;  // (cells + 1) points_[first_[c] .. first_[c + 1]) lie in cell c
};

}  // namespace palpable
