/// @file
/// What a full map gives up, so that a walk can go on for ever in bounded memory.
#pragma once

#include "palpable/live/track/landmark_map.h"
#include "palpable/live/track/map_limits.h"

namespace palpable {

/// Makes room: afterwards at most 7/8 of limits.keyframes and of limits.landmarks are left, unless
/// the newest keyframes alone hold more. It goes through these steps and stops as soon as there is
/// room:
///
/// 1. Landmarks that are dead, and those that were looked for 10 times or more and agreed in less
///    than a third of them. (This step is always made.)
/// 2. For too many keyframes: from the oldest on, those of whose landmarks 90 % are seen in three
///    others that stay (Mur-Artal et al., "ORB-SLAM", 2015, Sec. VI E).
/// 3. Keyframes from which the camera is farthest, |t| / Z + angle, Z their median depth; of equal
///    ones the oldest first.
///
/// A landmark is given up with the last keyframe that saw it; where its anchor alone goes it keeps
/// the anchor's pose. Indices of keyframes change, those of landmarks do not.
///
/// @param newest  how many keyframes stay in any case: their poses are still being adjusted
/// @param limits  limits.keyframes >= 2 * newest
/// @param map     its free_slots are overwritten
/// Takes about 1 ms for a full map, once in many keyframes.
/// @throws ContractViolation when the limits are too low
void make_room(const Rigid3& camera_from_world, const MapLimits& limits, int newest,
               LandmarkMap& map);

}  // namespace palpable
