/// @file
/// How deep the sharp parts of obstacles are inside a skin.
///
/// Contact is solved at contact points, which lie some 2 mm apart. An obstacle of radius r enters
/// between points at a distance s by s^2 / (6 r), in the middle of an equilateral triangle of them,
/// and a needle by any depth: near it every contact point is outside of it. Such a part is
/// therefore judged the other way round, by the signed distance phi of its axis from the skin's
/// triangles:
///
///     depth = max over the axis of  r(t) - phi(x(t)),        phi < 0 inside the skin
///
///             │ axis                      outside of the skin: by how far its surface is inside,
///             │                           inside: r + the way from its axis to the skin
///       ──────┼──────  skin
///             │  ▲
///             •  ┴ depth (r is small)
#pragma once

#include "palpable/common/contact/moving_surface.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpable {

/// m: an obstacle that is less deep inside a skin does not count: what the softness and the
/// distance of contact points leave.
inline constexpr double kReached = 3e-4;

/// m, the largest radius of an obstacle that may enter by kReached between contact points this far
/// apart (m).
[[nodiscard]] constexpr double sharpest_radius(double spacing) {
  return spacing * spacing / (6 * kReached);
}

/// The union of the balls whose centres lie between a and b, with a radius that changes linearly: a
/// part of an obstacle that is sharper than the distance of contact points. Body frame, m.
struct SharpPart {
  Eigen::Vector3f a = Eigen::Vector3f::Zero(), b = Eigen::Vector3f::Zero();
  float radius_a = 0, radius_b = 0;
};

/// The depth, in m, of a part of any radius inside a skin: the largest at both ends and the middle
/// of its axis; 0 unless it is inside with its whole radius at one of them. A part that crosses the
/// skin is judged at contact points; one that the skin encloses is near none of them, and all of
/// its axis is inside.
[[nodiscard]] double depth_of_enclosed(const SharpPart& part, const MovingSurface& skin);

/// m, how deep a part is inside a skin, to 0.15 mm or a tenth, whichever is more (coarser where
/// more than 45 mm of its axis lie along the skin); 0 if it is outside. Costs no query of the
/// surface for a part beside the skin's box, some 30 for one that is inside, 202 at most. Allocates
/// nothing.
[[nodiscard]] double depth_of(const SharpPart& part, const MovingSurface& skin);

}  // namespace palpable
