/// @file
/// Removes landmarks and keyframes from a full map, so that a walk of any length needs bounded
/// memory.
#pragma once

#include "palpable/live/track/landmark_map.h"
#include "palpable/live/track/map_limits.h"

namespace palpable {

/// Makes room: afterwards at most 7/8 of limits.keyframes and of limits.landmarks are left, unless
/// the newest keyframes alone need more. It removes, in this order and until there is room:
///
/// 1. Landmarks that are dead, and those that were searched 10 times or more and agreed in less
///    than a third of these searches. (This step is always done.)
/// 2. If there are too many keyframes: redundant ones, from the oldest on. A keyframe is redundant
///    if 90 % of its landmarks are seen in three others that stay (Mur-Artal et al., "ORB-SLAM",
///    2015, Sec. VI E).
/// 3. Keyframes that are farthest from the camera. The distance is |t| / Z + angle with Z the
///    keyframe's median depth; of equally distant ones the oldest goes first.
///
/// A landmark is removed together with the last keyframe that saw it. If only its anchor is
/// removed, the landmark stores the anchor's pose. Indices of keyframes change, those of landmarks
/// do not.
///
/// @param newest  number of newest keyframes that are never removed: they are still being adjusted
/// @param limits  limits.keyframes >= 2 * newest
/// @param map     its free_slots are overwritten
/// Takes about 1 ms for a full map, once in many keyframes.
/// @throws ContractViolation when the limits are too low
void make_room(const Rigid3& camera_from_world, const MapLimits& limits, int newest,
               LandmarkMap& map);

}  // namespace palpable
