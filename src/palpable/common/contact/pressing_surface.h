/// @file
/// What contact asks of the things that press a body: a signed distance to their surface, and how
/// each place of it is known.
///
///     phi(x) = min over balls  |x - centre| - radius           negative inside, m
///
/// Contact knows no camera: seen_object/object_surface.h makes such a surface of what one saw.
/// Body frame, metres.
#pragma once

#include "palpable/common/contact/object_ball.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>

namespace palpable {

/// How a place of the surface is known.
enum class Known {
  kMeasured,  ///< the camera sees it
  kAssumed,   ///< it is the other side of what the camera sees
  kUnknown    ///< it was there a moment ago, and nobody knows whether it still is
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

/// Queries allocate nothing.
class PressingSurface {
 public:
  virtual ~PressingSurface() = default;

  [[nodiscard]] virtual std::span<const ObjectBall> balls() const = 0;
  /// What the balls fill; empty without any.
  [[nodiscard]] virtual const Eigen::AlignedBox3f& bounds() const = 0;
  /// m: phi is exact up to here outside, and everywhere inside.
  [[nodiscard]] virtual float band() const = 0;
  /// m: how far what is measured has moved since the frame before, roughly; infinite where it has
  /// just come or gone. What is assumed does not count.
  [[nodiscard]] virtual double moved() const = 0;

  /// phi at x where it is below `reach`, which is at most the band; else nothing.
  [[nodiscard]] virtual std::optional<NearestOnObject> nearest(const Eigen::Vector3f& x,
                                                               float reach) const = 0;
  /// Whether that is something, to a float's rounding; cheaper.
  [[nodiscard]] virtual bool is_within(const Eigen::Vector3f& x, float reach) const = 0;
  /// The surface's shape where it is nearest to x; nothing when x is farther than the band. Costs
  /// some three times what nearest() does.
  [[nodiscard]] virtual std::optional<SurfaceShape> shape_at(const Eigen::Vector3f& x) const = 0;
};

}  // namespace palpable
