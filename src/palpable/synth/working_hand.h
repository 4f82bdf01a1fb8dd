/// @file
/// A hand at work before a camera that moves: it comes, does something, goes, and touches nothing.
#pragma once

#include "palpable/synth/camera_motions.h"
#include "palpable/synth/sequence.h"

#include <cstdint>
#include <functional>

namespace palpable {

/// The hand goes along with whoever carries the camera: its way is made in a frame that follows
/// `path` (a smooth one, without tremor). Covers 15-40 % of the view in more than half of the
/// frames from kFramesWithoutHand on, as far as the view of the ZED's left eye goes.
[[nodiscard]] std::function<Movers(double)> working_hand(CameraPath path, int frames,
                                                         std::uint64_t seed);

/// The share of `view` that the capsules cover, by one ray for each cell of a grid of
/// columns x rows.
[[nodiscard]] double covered_share(const std::vector<Capsule>& in_camera, const PinholeCamera& view,
                                   int columns, int rows);

}  // namespace palpable
