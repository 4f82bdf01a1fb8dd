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
/// `palpable bench surface` judges it against true things. The session still asks SeenSurface
/// (seen_surface.h), a ball as thick as a finger behind every pixel; the issue "What presses" lets
/// it ask here.
#pragma once

#include "palpable/contact/ball_tree.h"
#include "palpable/contact/medial_balls.h"
#include "palpable/contact/silhouette.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

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
};

/// A ball of the union, with the place where its thing is seen.
struct ObjectBall {
  Eigen::Vector3f point;   ///< m, body frame, on the seen front
  Eigen::Vector3f normal;  ///< unit, outwards: to the camera's side
  Eigen::Vector3f centre;  ///< m
  float depth = 0;         ///< Z of the point in the camera, m: what its noise depends on
  float radius = 0.008f;   ///< m
};

/// What is nearest to a query point.
struct NearestOnObject {
  float distance = 0;       ///< phi, m; negative inside
  int ball = 0;             ///< index into balls()
  bool is_measured = true;  ///< the camera sees that side of it; else it is assumed
};

/// Built anew for each frame; keeps its memory, so that building allocates nothing once a frame
/// with as much to see was built.
class ObjectSurface {
 public:
  /// @throws ContractViolation if a step or reach is below 1, or a length is not positive
  explicit ObjectSurface(const ObjectSurfaceSettings& settings = {});

  /// Makes balls of the things that lie near `region_in_body`.
  ///
  /// @param depth    Z in m, NaN where unknown: no depth, no thing. Zero, negative and infinite
  ///                 values count as unknown.
  /// @param presses  255 where a pixel may belong to a thing that presses; empty: all of them
  /// @param camera   of the depth image: same width and height
  void build(const DepthImage& depth, const MaskImage& presses, const PinholeCamera& camera,
             const Rigid3& body_from_camera, const Eigen::AlignedBox3d& region_in_body);

  /// Uses these balls as they are (tests, other sensors), seen from `camera_in_body`. Balls that
  /// cannot reach into the region's band are left out.
  void build(std::span<const ObjectBall> balls, const Eigen::AlignedBox3d& region_in_body,
             const Eigen::Vector3f& camera_in_body = Eigen::Vector3f::Zero());

  [[nodiscard]] std::span<const ObjectBall> balls() const { return balls_; }
  /// Seen points near the region, thinned out by settings.step: the cloud of Algorithm 1.
  [[nodiscard]] std::span<const Eigen::Vector3f> cloud() const { return cloud_; }
  [[nodiscard]] const ObjectSurfaceSettings& settings() const { return settings_; }

  /// phi at x; nothing when x is farther than the band from all balls. Allocates nothing.
  [[nodiscard]] std::optional<NearestOnObject> nearest(const Eigen::Vector3f& x) const;

  /// The same by looking at every ball: what nearest() is tested against.
  [[nodiscard]] std::optional<NearestOnObject> nearest_by_brute_force(
      const Eigen::Vector3f& x) const;

 private:
  void start(const Eigen::AlignedBox3d& region_in_body, const Eigen::Vector3f& camera_in_body);
  void keep(const ObjectBall& ball);
  void finish();
  [[nodiscard]] NearestOnObject answer(const Eigen::Vector3f& x, float distance, int ball) const;

  ObjectSurfaceSettings settings_;
  Eigen::AlignedBox3f region_;  // grown by the band
  Eigen::Vector3f camera_ = Eigen::Vector3f::Zero();
  Silhouette silhouette_;
  std::vector<MedialBall> found_;  // camera frame
  std::vector<ObjectBall> balls_;
  std::vector<Eigen::Vector3f> cloud_;
  std::vector<Ball> bare_;
  BallTree tree_;
};

}  // namespace palpable
