/// @file
/// The real world near a body as one camera sees it: a signed distance to the things that press
/// (paper Sec. 3.4, the "level set" of Figs. 7 and 8).
///
/// The camera sees only the front of a hand. What lies behind is told by how wide it is
/// (medial_balls.h): the thing is a union of balls behind the middle of its silhouette,
///
///     phi(x) = min over balls  |x - centre| - radius           negative inside, m
///
/// Where the surface of the union faces the camera it was *measured*; its other side is *assumed*.
///
/// Body frame, metres. The distance is exact in a band around the surface and unknown outside.
///
/// `palpable bench surface` judges it against true things.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/contact/ball_tree.h"
#include "palpable/live/contact/creases.h"
#include "palpable/live/contact/held_balls.h"
#include "palpable/live/contact/medial_balls.h"
#include "palpable/live/contact/object_ball.h"
#include "palpable/live/contact/ray_to_region.h"
#include "palpable/live/contact/rest_filter.h"
#include "palpable/live/contact/silhouette.h"

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
  /// How far one pixel's depth scatters round the true one,
  ///     sigma(Z) = noise_constant + noise_linear Z + noise_quadratic Z^2    (m, 1, 1/m).
  /// Disparity has a constant error, so stereo has the square alone.
  double noise_constant = 0;
  double noise_linear = 0;
  double noise_quadratic = 0.006;
  /// So many neighbouring pixels have one error: a matcher's windows overlap, and it smooths.
  double pixels_alike = 6;
};

/// How a place of the surface is known.
enum class Known {
  kMeasured,  ///< the camera sees it
  kAssumed,   ///< it is the other side of what the camera sees
  kUnknown    ///< it was there a moment ago, and nobody knows whether it still is (held_balls.h)
};

/// What is nearest to a query point.
struct NearestOnObject {
  float distance = 0;  ///< phi, m; negative inside
  int ball = 0;        ///< index into balls()
  Known known = Known::kMeasured;
};

/// The surface that is nearest to a query point as a smooth one: what contact with it needs.
///
/// A union of balls has bumps between neighbouring ones. Normal and curvature are therefore
/// differences of phi over half a ball's radius, which averages a few bumps.
struct SurfaceShape {
  float distance = 0;      ///< phi, m; negative inside
  Eigen::Vector3f normal;  ///< unit, in which phi grows fastest: out of the object
  /// 1/m, of the level set of phi through the query point: how fast the normal turns,
  /// dn = curvature dx. Symmetric, curvature * normal = 0; (I - n n^T) / R round a ball whose
  /// middle is R away, negative where the object is hollow.
  Eigen::Matrix3f curvature;
  float sigma = 0;  ///< m, how far the place scatters along the normal
  Known known = Known::kMeasured;
};

/// Built anew for each frame; keeps its memory, and has room for 8,192 balls from the start, so
/// that building allocates nothing after the first frame.
class ObjectSurface {
 public:
  /// @throws ContractViolation if a step or reach is below 1, or a length is not positive
  explicit ObjectSurface(const ObjectSurfaceSettings& settings = {});

  /// Makes balls of the things that lie near `region_in_body`.
  ///
  /// @param depth    Z in m, NaN where unknown: no depth, no thing. Zero, negative and infinite
  ///                 values count as unknown.
  /// @param shows    of each pixel kShowsRoom..., kShowsPresser or kShowsUnknown
  /// (geometry/image.h);
  ///                 empty: what is measured presses, what is not is unknown
  /// @param camera   of the depth image: same width and height
  /// @param time     s, of the frame: what it neither sees nor sees through is held (held_balls.h)
  void build(const DepthImage& depth, const MaskImage& shows, const PinholeCamera& camera,
             const Rigid3& body_from_camera, const Eigen::AlignedBox3d& region_in_body,
             double time = 0);

  /// The part of the image in which things that matter to `region_in_body` may be seen.
  [[nodiscard]] PixelBox box_of_interest(const Eigen::AlignedBox3d& region_in_body,
                                         const Rigid3& camera_from_body,
                                         const PinholeCamera& camera) const;

  /// Uses these balls as they are (tests, other sensors), seen from `camera_in_body`. Balls that
  /// cannot reach into the region's band are left out.
  void build(std::span<const ObjectBall> balls, const Eigen::AlignedBox3d& region_in_body,
             const Eigen::Vector3f& camera_in_body = Eigen::Vector3f::Zero());

  [[nodiscard]] std::span<const ObjectBall> balls() const { return balls_; }
  /// The cloud of Algorithm 1: the pixels that press near the region, thinned out by settings.step,
  /// at the depth that this frame measured (not the average over frames, of which balls are made).
  [[nodiscard]] std::span<const Eigen::Vector3f> cloud() const { return cloud_; }
  /// How many points the cloud of a depth image of this size can have, from the first build on.
  [[nodiscard]] std::size_t cloud_room() const { return cloud_.capacity(); }
  [[nodiscard]] const ObjectSurfaceSettings& settings() const { return settings_; }
  /// What the balls fill; empty without any.
  [[nodiscard]] const Eigen::AlignedBox3f& bounds() const { return bounds_; }

  /// m: how far what is measured has moved since the build before, roughly; infinite where it has
  /// just come or gone. From how far it reaches in 26 directions: what is assumed does not count,
  /// nor do balls that come and go amid it.
  [[nodiscard]] double moved() const { return moved_; }

  /// phi at x; nothing when x is farther than the band from all balls. Allocates nothing.
  [[nodiscard]] std::optional<NearestOnObject> nearest(const Eigen::Vector3f& x) const {
    return nearest(x, static_cast<float>(settings_.band));
  }
  /// The same where phi is below `reach`, which is at most the band.
  [[nodiscard]] std::optional<NearestOnObject> nearest(const Eigen::Vector3f& x, float reach) const;
  /// Whether that is something, to a float's rounding; told sooner.
  [[nodiscard]] bool is_within(const Eigen::Vector3f& x, float reach) const {
    return tree_.is_any_within(x, reach);
  }

  /// The surface's shape where it is nearest to x; nothing when x is farther than the band. Costs
  /// some three times what nearest() does; allocates nothing.
  [[nodiscard]] std::optional<SurfaceShape> shape_at(const Eigen::Vector3f& x) const;

  /// The same as nearest() by looking at every ball: what it is tested against.
  [[nodiscard]] std::optional<NearestOnObject> nearest_by_brute_force(
      const Eigen::Vector3f& x) const;

 private:
  [[nodiscard]] Eigen::AlignedBox3d fronts_near(const Eigen::AlignedBox3d& region) const;
  void start(const Eigen::AlignedBox3d& region_in_body, const Eigen::Vector3f& camera_in_body);
  void keep(const ObjectBall& ball);
  void finish();
  void find_moved();
  [[nodiscard]] NearestOnObject answer(const Eigen::Vector3f& x, float distance, int index) const;

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
  Eigen::AlignedBox3f bounds_;
  Eigen::Vector3f camera_ = Eigen::Vector3f::Zero();
  Silhouette silhouette_;
  Creases creases_;
  std::vector<MedialBall> found_;  // camera frame
  std::vector<ObjectBall> balls_;
  std::vector<Eigen::Vector3f> cloud_;
  std::vector<Ball> bare_;
  std::array<float, 26> reach_{};  // m, of the measured fronts in as many directions
  bool measured_ = false;          // whether there are such
  Eigen::Vector3f way_ = Eigen::Vector3f::Zero();  // m, half of it, since the build before
  double moved_ = 0;
  BallTree tree_;
  RestFilter rest_;
  HeldBalls held_;
  MaskImage all_;  // what is shown where nobody says so
};

}  // namespace palpable
