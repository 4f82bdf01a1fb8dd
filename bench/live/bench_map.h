/// @file
/// The part of `bench track` that measures the map and the moving mask.
#pragma once

#include "apps/common/json.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/synth/sequence.h"

#include <cstdint>

namespace palpable::app {

class ProgressBar;

/// The last frames of the film are without the hand.
inline constexpr int kFramesAfterHand = 15;
inline constexpr int kFewestHandFrames = kFramesWithoutHand + 2 * kFramesAfterHand;

/// Films `frames` (>= kFewestHandFrames) of walk-hand and follows them as `palpable live` does, the
/// depth measured, the poses tracked.
///
///     map_ms                CPU of one fused depth image, its thread's; mean from the hand on
///     mask_ms               the same of one frame's mask and free space
///     ghost_voxels          cells of the map's surface, when the hand has gone, that lie where it
///                           was (within two voxels) and before all that is there in truth
///     ghost_voxels_no_mask  the same of a map that took the hand in, just before the hand goes:
///                           what the count is when it should not be 0
///
/// In truth: of all that lies within 3 px the nearest, less max(40 mm, 4 sigma) for the error of
/// a measured surface. @throws Error without OpenGL
void bench_map(const ReducedBody& body, std::uint64_t seed, int frames, ProgressBar& bar,
               Json& result);

}  // namespace palpable::app
