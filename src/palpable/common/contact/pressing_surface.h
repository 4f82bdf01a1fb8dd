/// @file
/// The obstacles that a camera sees: the signed distance to a union of balls, and for each point of
/// its surface whether it was measured or is assumed.
///
///     phi(x) = min over balls  |x - centre| - radius           negative inside, m
///
/// seen_object/object_surface.h implements it from a depth image. Body frame, metres.
#pragma once

#include "palpable/common/contact/obstacles.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>

namespace palpable {

/// A ball of the union that stands for seen obstacles, with the position at which its obstacle was
/// seen. Body frame.
struct ObjectBall {
  Eigen::Vector3f point;   ///< m, on the seen front
  Eigen::Vector3f normal;  ///< unit, outwards: to the camera's side
  Eigen::Vector3f centre;  ///< m
  float radius = 0.008f;   ///< m
  float sigma = 0;         ///< m, standard deviation of the measured surface
  float unseen_for = 0;    ///< s since it was measured; 0: in this frame
  // Of friction (seen_object/surface_friction.h).
  /// m, how far its obstacle has moved since the frame before
  Eigen::Vector3f way = Eigen::Vector3f::Zero();
  float friction_share = 0;  ///< 0 to 1, of the body's coefficient; 0: it rubs nothing
  /// Whether `way` is the mean of its thing, as not enough is known of its own.
  bool way_is_mean = false;
};

/// The surface nearest to a query point.
struct NearestOnObject {
  float distance = 0;  ///< phi, m; negative inside
  int ball = 0;        ///< index into balls()
  Known known = Known::kMeasured;
};

/// A smooth approximation of the surface near a query point: the gap, normal and curvature that a
/// step of Newton's method needs.
///
/// A union of balls has a crease between neighbouring balls. Normal and curvature are therefore
/// finite differences of phi over half a ball's radius, which averages over a few creases.
struct SurfaceShape {
  float distance = 0;      ///< phi, m; negative inside
  Eigen::Vector3f normal;  ///< unit, the direction of the gradient of phi: out of the object
  /// 1/m, second derivative of phi, so that the normal turns by dn = curvature dx. Symmetric, with
  /// curvature * normal = 0. At distance R from the centre of a ball it is (I - n n^T) / R; where
  /// the surface is concave it has negative eigenvalues.
  Eigen::Matrix3f curvature;
  float sigma = 0;  ///< m, standard deviation of the surface along the normal
  Known known = Known::kMeasured;
  float unseen_for = 0;      ///< s since it was measured; 0: in this frame
  float friction_share = 0;  ///< ObjectBall::friction_share
};

/// Queries allocate nothing.
class PressingSurface : public Obstacles {
 public:
  /// A gap is finite up to band(), which is less than kGapReach. SurfaceGap::softness is sigma / 10
  /// mm: a surface that is known to 10 mm doubles the compliance of a contact point.
  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override;
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override;
  [[nodiscard]] float depth_at(const Eigen::Vector3f& place) const override;
  /// The balls that are so small, each with its centre inside `box`: what one camera sees is too
  /// uncertain for a judgement of balls beside the skin.
  void add_sharp_parts(const Eigen::AlignedBox3f& box, float radius,
                       std::vector<SharpPart>& parts) const override;

  /// A gap has the share of the nearest ball (ObjectBall::friction_share) of the body's
  /// coefficient.
  [[nodiscard]] float largest_friction(float of_body) const override {
    return friction_share() * of_body;
  }
  /// A place moves as the ball nearest to it (ObjectBall::way); there are no parts.
  [[nodiscard]] std::optional<MaterialPoint> carried(const MaterialPoint& before) const override;
  [[nodiscard]] std::optional<Eigen::Vector3f> way_of(const MaterialPoint& now) const override;

  /// 0 to 1: the largest ObjectBall::friction_share. 0: there is no friction.
  [[nodiscard]] virtual float friction_share() const { return 0; }
  [[nodiscard]] virtual std::span<const ObjectBall> balls() const = 0;
  /// Bounding box of the balls; empty without any.
  [[nodiscard]] virtual const Eigen::AlignedBox3f& bounds() const = 0;
  /// m: phi is exact up to this distance outside the surface, and everywhere inside.
  [[nodiscard]] virtual float band() const = 0;
  /// m: an estimate of the largest displacement of the measured surface since the previous frame;
  /// infinite in a frame in which a thing appears or disappears. The assumed far side is left out.
  [[nodiscard]] virtual double moved() const = 0;

  /// phi at x where it is below `reach`, which is at most the band; else nothing.
  [[nodiscard]] virtual std::optional<NearestOnObject> nearest(const Eigen::Vector3f& x,
                                                               float reach) const = 0;
  /// Whether nearest(x, reach) returns something, up to float rounding; cheaper than the call.
  [[nodiscard]] virtual bool is_within(const Eigen::Vector3f& x, float reach) const = 0;
  /// The surface's shape near x; nothing where phi is above the band. Costs about three times what
  /// nearest() does.
  [[nodiscard]] virtual std::optional<SurfaceShape> shape_at(const Eigen::Vector3f& x) const = 0;
};

}  // namespace palpable
