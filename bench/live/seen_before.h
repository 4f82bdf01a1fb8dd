/// @file
/// Which points of the true things a camera saw before, in earlier frames of a film.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"

#include "bench/live/thing_points.h"
#include <optional>
#include <span>
#include <vector>

namespace palpable::app {

/// The rigid motion of one capsule from one frame to another, now_from_then. A capsule alone does
/// not tell how it turned about its own axis. So the motion is first fitted to the ends of all
/// capsules nearby, robustly, and then turned by the smallest angle at which the capsule's own axis
/// fits exactly. That is right for a rigid thing and for the hand that holds it; a bending finger
/// is taken to turn about its axis as its neighbours do.
///
/// Capsules are matched from the end of the lists, since a hand, which comes first, may leave while
/// a thing stays.
/// @param now, then  camera frame of their frames, m
/// @param thing      index in `now`
/// @return nothing when the capsule is not in `then`, or has another size there
[[nodiscard]] std::optional<Rigid3> motion_of_thing(std::span<const Capsule> now,
                                                    std::span<const Capsule> then, int thing);

/// For each point whether the camera saw it in one of the earlier frames, where the point moves
/// with its capsule. "Sees" is that of Side::kFront: nothing lies before it on the ray from the
/// left eye, and it is inside the picture.
/// @param points   on the capsules `now`
/// @param earlier  the capsules in earlier frames, each in the camera frame of its frame
[[nodiscard]] std::vector<bool> seen_before(const ThingPoints& points, std::span<const Capsule> now,
                                            std::span<const std::span<const Capsule>> earlier,
                                            const PinholeCamera& camera);

}  // namespace palpable::app
