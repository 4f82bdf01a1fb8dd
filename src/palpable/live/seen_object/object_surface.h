/// @file
/// The real world near a body as one camera sees it: a signed distance to the pressers
/// (paper Sec. 3.4, the "level set" of Figs. 7 and 8).
///
/// The camera sees only the front of a hand. Its other side is estimated from its width
/// (medial_balls.h): the thing is a union of balls behind the middle of its silhouette,
///
///     phi(x) = min over balls  |x - centre| - radius           negative inside, m
///
/// Where the surface of the union faces the camera it was *measured*; its other side is *assumed*.
///
///     depth, colour ──► PressingMask ──► Silhouette ──► medial_balls, creases ──► HeldBalls ──┐
///                       which pixels     outlines of    the balls                 those seen  │
///                       may press        things                                   before      │
///                                                                                             ▼
///     ContactSolver ◄── gaps ── ObjectSurface (PressingSurface, an Obstacles) ◄── BallTree ◄──┘
///
/// Body frame, metres. The distance is exact in a band around the surface and unknown outside.
///
/// `palpable bench surface` compares it with the true shapes of synthetic things.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/seen_object/ball_tree.h"
#include "palpable/live/seen_object/ball_union.h"
#include "palpable/live/seen_object/creases.h"
#include "palpable/live/seen_object/held_balls.h"
#include "palpable/live/seen_object/medial_balls.h"
#include "palpable/live/seen_object/ray_to_region.h"
#include "palpable/live/seen_object/rest_filter.h"
#include "palpable/live/seen_object/silhouette.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct ObjectSurfaceSettings {
  /// N_step of Algorithm 1: every step-th pixel of every step-th row becomes a point of the cloud.
  int step = 2;
  double band = 0.010;  ///< m, phi is exact up to here outside, and everywhere inside
  SilhouetteSettings silhouette{};
  MedialBallSettings balls{};
  RestFilterSettings rest{};
  HoldSettings hold{};
  /// The standard deviation of one pixel's depth,
  ///     sigma(Z) = noise_constant + noise_linear Z + noise_quadratic Z^2    (m, 1, 1/m).
  /// Disparity has a constant error, so stereo has the quadratic term alone.
  double noise_constant = 0;
  double noise_linear = 0;
  double noise_quadratic = 0.006;
  /// Number of neighbouring pixels that share one error, because a matcher's windows overlap and it
  /// smooths: n pixels count as n / pixels_alike independent measurements.
  double pixels_alike = 6;
};

/// The signed distance. Built anew for each frame; keeps its memory, and has room for 8,192 balls
/// from the start, so that building allocates nothing after the first frame.
class ObjectSurface final : public BallUnion {
 public:
  /// @throws ContractViolation if a step or reach is below 1, or a length is not positive
  explicit ObjectSurface(const ObjectSurfaceSettings& settings = {});

  /// Makes balls of the things that lie near `region_in_body`.
  ///
  /// @param depth    Z in m, NaN where unknown: no depth, no thing. Zero, negative and infinite
  ///                 values count as unknown.
  /// @param shows    for each pixel kShowsRoom..., kShowsPresser or kShowsUnknown
  ///                 (geometry/image.h); empty: pixels with depth are pressers, the others unknown
  /// @param camera   of the depth image: same width and height
  /// @param time     s, of the frame; balls that are no longer seen are held by it (held_balls.h)
  /// @param coverage share of each pixel that shows a presser (PressingMask::coverage()), of the
  ///                 depth's size; null: 1 at pressers, 0 elsewhere
  void build(const DepthImage& depth, const MaskImage& shows, const PinholeCamera& camera,
             const Rigid3& body_from_camera, const Eigen::AlignedBox3d& region_in_body,
             double time = 0, const Image<float>* coverage = nullptr);

  /// The part of the image in which things may be seen whose balls can reach into `region_in_body`.
  [[nodiscard]] PixelBox box_of_interest(const Eigen::AlignedBox3d& region_in_body,
                                         const Rigid3& camera_from_body,
                                         const PinholeCamera& camera) const;

  /// Uses these balls as they are (tests, other sensors), seen from `camera_in_body`. Balls that
  /// cannot reach into the region's band are left out.
  void build(std::span<const ObjectBall> balls, const Eigen::AlignedBox3d& region_in_body,
             const Eigen::Vector3f& camera_in_body = Eigen::Vector3f::Zero());

  /// What friction needs to know of a ball (surface_friction.h): the members of ObjectBall.
  struct BallMotion {
    Eigen::Vector3f way = Eigen::Vector3f::Zero();  ///< m
    float friction_share = 0;
    bool way_is_mean = false;
  };
  /// Sets the motion of each ball since the frame before. Until then balls of a depth image rub
  /// nothing. @param motion  in the order of balls()
  void set_motion(std::span<const BallMotion> motion);
  /// The last surface before this one that had balls, in the order that balls() had.
  [[nodiscard]] const BallTree& before() const { return before_; }
  [[nodiscard]] const Obstacles* on_the_way(float done) const override;
  [[nodiscard]] float largest_way() const override;
  /// The point cloud of Algorithm 1: the pixels of pressers near the region, thinned out by
  /// settings.step, at the depth measured in this frame (balls are made of averages over frames).
  [[nodiscard]] std::span<const Eigen::Vector3f> cloud() const { return cloud_; }
  /// The largest number of points that the cloud of a depth image of this size can have; known from
  /// the first build on.
  [[nodiscard]] std::size_t cloud_room() const { return cloud_.capacity(); }
  [[nodiscard]] const ObjectSurfaceSettings& settings() const { return settings_; }
  /// Found from the extent of the measured fronts in 26 directions, so that balls that appear and
  /// vanish inside of a thing have no influence.
  [[nodiscard]] double moved() const override { return moved_; }

  /// As nearest(), by a search of all balls; tests compare nearest() with it.
  [[nodiscard]] std::optional<NearestOnObject> nearest_by_brute_force(
      const Eigen::Vector3f& x) const;

 private:
  [[nodiscard]] Eigen::AlignedBox3d fronts_near(const Eigen::AlignedBox3d& region) const;
  void start(const Eigen::AlignedBox3d& region_in_body, const Eigen::Vector3f& camera_in_body);
  void keep(const ObjectBall& ball);
  void finish();
  void find_moved();

  [[nodiscard]] const MaskImage& everything_measured(const DepthImage& depth);
  [[nodiscard]] PixelBox box_of_things(const DepthImage& depth, const MaskImage& shows,
                                       const PinholeCamera& camera, const PixelBox& interest,
                                       const RayToRegion& to_body,
                                       const Eigen::AlignedBox3f& near) const;
  void fill_cloud(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
                  const RayToRegion& to_body, const Eigen::AlignedBox3f& near);
  [[nodiscard]] float sigma_of(float depth, int pixels) const;
  [[nodiscard]] double noise_at(double Z) const;

  ObjectSurfaceSettings settings_;
  Eigen::AlignedBox3f region_;  // grown by the band
  Silhouette silhouette_;
  Creases creases_;
  std::vector<MedialBall> found_;  // camera frame
  std::vector<Eigen::Vector3f> cloud_;
  std::array<float, 26> reach_{};  // m, extent of the measured fronts along 26 directions
  bool measured_ = false;          // whether any front was measured
  // m, displacement since the previous build; about half of it for a thing that is cut off.
  Eigen::Vector3f way_ = Eigen::Vector3f::Zero();
  double moved_ = 0;
  BallTree before_;
  RestFilter rest_;
  HeldBalls held_;
  mutable BallUnion on_the_way_;
  MaskImage all_;  // the mask that stands for an empty `shows`
};

}  // namespace palpable
