/// @file
/// The part of `bench track` that measures the map and the moving mask.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/script/plan_sequence.h"

#include <cstdint>

namespace palpable::app {

class ProgressBar;

/// The last frames of the clip are without the hand.
inline constexpr int kFramesAfterHand = 15;
inline constexpr int kFewestHandFrames = kFramesWithoutHand + 2 * kFramesAfterHand;

/// Renders `frames` (>= kFewestHandFrames) of walk-hand and processes them as `palpable live` does,
/// with measured depth and tracked poses.
///
///     map_ms                CPU ms of fusing one depth image; mean from the hand on
///     mask_ms               CPU ms of one frame's mask and free space; mean from the hand on
///     ghost_voxels          vertices of the map's surface, when the hand has gone, that lie where
///                           it was (within two voxels) and before all true surfaces
///     ghost_voxels_no_mask  the same of a map into which the hand was fused, just before the hand
///                           goes: shows that the count finds ghosts when there are some
///
/// "Before all true surfaces" means: nearer than the nearest of them within 3 px by more than
/// max(40 mm, 4 sigma), the error of a measured surface.
/// @throws Error without OpenGL
void bench_map(const ReducedBody& body, std::uint64_t seed, int frames, ProgressBar& bar,
               Json& result);

}  // namespace palpable::app
