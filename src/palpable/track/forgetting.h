/// @file
/// What a full map gives up, so that a walk can go on for ever in bounded memory.
///
/// Landmarks lie in slots that are used again; keyframes stay in the order of their frames.
#pragma once

#include "palpable/track/landmark_map.h"
#include "palpable/track/map_limits.h"

#include <vector>

namespace palpable {

/// Makes room: afterwards at most 7/8 of limits.keyframes and of limits.landmarks are left, unless
/// the newest keyframes alone hold more. Nothing is given up that need not be. In this order:
///
/// 1. Landmarks that are dead, and those that were looked for 10 times or more and agreed in less
///    than a third of them.
/// 2. For too many keyframes: from the oldest on, those of whose landmarks 90 % are seen in three
///    others that stay (Mur-Artal et al., "ORB-SLAM", 2015, Sec. VI E).
/// 3. Keyframes from which the camera is farthest, |t| / Z + angle, Z their median depth; of equal
///    ones the oldest first.
///
/// A landmark goes with the last keyframe that saw it; where its anchor alone goes it keeps the
/// anchor's pose. Indices of keyframes change, those of landmarks do not.
///
/// @param newest       keyframes that stay: their poses are still being adjusted
/// @param limits       the keyframes' at least twice as many
/// @param free_slots   of `landmarks`, those that hold nothing; overwritten
/// Of the order of the numbers of sightings: about 1 ms for a full map, once in many keyframes.
void make_room(const Rigid3& camera_from_world, const MapLimits& limits, int newest,
               std::vector<Keyframe>& keyframes, std::vector<Landmark>& landmarks,
               std::vector<int>& free_slots);

}  // namespace palpable
