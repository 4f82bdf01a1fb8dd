/// @file
/// The obstacles of a body, as the contact solver sees them: a set that returns the signed
/// distances of positions, many in one call. Other bodies are not part of it.
///
///     g(x) = distance of x from the nearest obstacle, m, negative inside it
///
/// Implemented by the surface that a camera sees (pressing_surface.h), by capsules
/// (capsule_obstacles.h), by the obstacles of the full solver (touch_bake/touch_difference.h), and
/// in tests by functions.
#pragma once

#include "palpable/common/contact/sharp_part.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Where a point of an obstacle's surface comes from.
enum class Known {
  kMeasured,  ///< seen in this frame, or exact
  kAssumed,   ///< the far side of what is seen, which the camera cannot see
  kUnknown    ///< seen in an earlier frame, hidden or without depth in this one
};

/// SurfaceGap::friction: that of the body. Another negative number is minus a share of it.
inline constexpr float kFrictionOfBody = -1;
/// Coulomb's coefficient of a gap. @param given  SurfaceGap::friction @param of_body  the body's
[[nodiscard]] inline float friction_coefficient(float given, float of_body) {
  return given < 0 ? -given * of_body : given;
}

/// Coulomb's coefficient between two bodies with these: the root of their product.
[[nodiscard]] inline double friction_between(double one, double other) {
  return std::sqrt(one * other);
}

/// A material point of an obstacle.
struct MaterialPoint {
  int part = -1;                                    ///< SurfaceGap::part
  Eigen::Vector3f place = Eigen::Vector3f::Zero();  ///< m, body frame
};

/// The signed distance of a position from the nearest obstacle, to second order.
struct SurfaceGap {
  /// m, negative inside the obstacle; infinite where no obstacle is within kGapReach
  float distance = std::numeric_limits<float>::infinity();
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit, out of the obstacle
  /// Second derivative of the distance, 1/m: a ball of radius r has (1 - n n^T) / r.
  Eigen::Matrix3f curvature = Eigen::Matrix3f::Zero();
  /// Additional compliance of the contact as a ratio to the body's own at the point, in addition to
  /// TouchSettings::softness: an obstacle whose position is uncertain presses softly.
  float softness = 0;
  Known known = Known::kMeasured;
  float unseen_for = 0;  ///< s since the obstacle was measured; 0: it is now
  /// Which of several things the obstacle belongs to (CapsuleObstacles::set()); -1: not known.
  int thing = -1;
  int part = -1;  ///< which part of the obstacles is nearest; -1: they have no parts
  /// Coulomb's coefficient of friction between obstacle and skin; < 0: kFrictionOfBody
  float friction = 0;

  /// Whether there is an obstacle, and all numbers are finite.
  [[nodiscard]] bool is_known() const {
    return std::isfinite(distance) && normal.allFinite() && curvature.allFinite();
  }
};

/// The gap at a position near the one for which it was queried, to second order.
struct GapBeside {
  float farther = 0;       ///< m, the change of the distance
  Eigen::Vector3f normal;  ///< unit
};
/// @param way  m, from the position at which normal and curvature (SurfaceGap) were queried
[[nodiscard]] inline GapBeside gap_beside(const Eigen::Vector3f& normal,
                                          const Eigen::Matrix3f& curvature,
                                          const Eigen::Vector3f& way) {
  const Eigen::Vector3f turn = curvature * way;
  return {normal.dot(way) + 0.5f * way.dot(turn), (normal + turn).normalized()};
}

/// m: Obstacles return gaps up to this distance at most.
inline constexpr float kGapReach = 0.012f;

/// Queries allocate nothing once as many positions were queried before. Not to be used by two
/// threads at a time.
class Obstacles {
 public:
  virtual ~Obstacles() = default;

  /// The gap of each position. Called once in each iteration of Newton's method, for all contacts;
  /// before that point by point, to find these. A gap that is not finite counts as no obstacle.
  /// @param places  m, body frame
  /// @param gaps    as many, overwritten; SurfaceGap::distance is infinite where nothing is within
  ///                kGapReach, or an implementation's shorter reach
  virtual void find_gaps(std::span<const Eigen::Vector3f> places,
                         std::span<SurfaceGap> gaps) const = 0;

  /// Whether an obstacle may be nearer to a position than `reach` (m), which may exceed kGapReach:
  /// a cheaper query, made first. True if that is not known.
  [[nodiscard]] virtual bool may_be_within(const Eigen::Vector3f& place, float reach) const = 0;

  /// m, how deep a position is inside an obstacle; 0 outside. Obstacles for which that is cheaper
  /// than find_gaps() override it.
  [[nodiscard]] virtual float depth_at(const Eigen::Vector3f& place) const {
    SurfaceGap gap;
    find_gaps({&place, 1}, {&gap, 1});
    return std::isfinite(gap.distance) ? std::max(0.0f, -gap.distance) : 0.0f;
  }

  /// Whether add_sharp_parts() knows every part of the obstacle, as it is. A surface that a camera
  /// sees is a sample with an assumed far side.
  [[nodiscard]] virtual bool has_exact_parts() const { return false; }

  // Friction. Obstacles whose motion is not known rub nothing, and leave these as they are.

  /// The largest coefficient of friction that a gap may have, where the body's is `of_body`. With 0
  /// no other function of friction is called.
  [[nodiscard]] virtual float largest_friction(float of_body) const {
    return static_cast<void>(of_body), 0.0f;
  }
  /// A material point of the frame before in this one; nothing if its part is gone. A point of a
  /// part that stands still is returned unchanged, to the bit.
  [[nodiscard]] virtual std::optional<MaterialPoint> carried(const MaterialPoint& before) const {
    return static_cast<void>(before), std::nullopt;
  }
  /// m, the way since the frame before of the material point that is here now; nothing if its part
  /// is new, or the motion is not known.
  [[nodiscard]] virtual std::optional<Eigen::Vector3f> way_of(const MaterialPoint& now) const {
    return static_cast<void>(now), std::nullopt;
  }

  /// The obstacles on their way from the frame before (0) to this one (1), with the same parts:
  /// what is `done` of it. Parts whose motion is not known stand where they are. They are valid
  /// until the next call, and until these obstacles are others; null: no motion is known.
  [[nodiscard]] virtual const Obstacles* on_the_way(float done) const {
    return static_cast<void>(done), nullptr;
  }

  /// m, no part has come farther since the frame before, or will have on its way in the frame.
  /// Infinite: not known.
  [[nodiscard]] virtual float largest_way() const { return std::numeric_limits<float>::infinity(); }

  /// Adds the parts whose radius is below `radius` (m) somewhere and that may be inside `box` (m),
  /// as long as `parts` has capacity. Obstacles without sharp parts, and those that do not know
  /// them, add none.
  virtual void add_sharp_parts(const Eigen::AlignedBox3f& box, float radius,
                               std::vector<SharpPart>& parts) const {
    static_cast<void>(box), static_cast<void>(radius), static_cast<void>(parts);
  }
};

/// The gap of one position.
[[nodiscard]] inline SurfaceGap gap_at(const Obstacles& obstacles, const Eigen::Vector3f& place) {
  SurfaceGap gap;
  obstacles.find_gaps({&place, 1}, {&gap, 1});
  return gap;
}

}  // namespace palpable
