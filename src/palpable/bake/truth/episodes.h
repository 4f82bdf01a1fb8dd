/// @file
/// Which frames of a filmed clip are solved for, and where its hand was between two frames.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/desk/clip_files/clip_hands.h"
#include "palpable/desk/clip_files/frame_records.h"

#include <vector>

namespace palpable {

/// One touch, and the frames of it that are solved for.
struct Episode {
  int first = 0;            ///< the first touching frame
  std::vector<int> wanted;  ///< frames whose solution is wanted, increasing
};

/// Chooses `count` frames, evenly spread over the touching ones whose depth (m) is at most
/// `deepest`, and groups them by touch. A touch ends where `apart` frames in succession have none.
/// @return fewer than `count` where fewer frames touch
[[nodiscard]] std::vector<Episode> episodes_of(const std::vector<ContactLine>& contacts, int count,
                                               double deepest, int apart = 1);

/// The capsules at a time between two frames, by linear interpolation of their ends and radii.
/// Where the two frames have different numbers of capsules, those of the nearer frame.
/// @param t  in frames; clamped to the first and the last frame
[[nodiscard]] std::vector<Capsule> capsules_at(const ClipHands& hands, double t);

}  // namespace palpable
