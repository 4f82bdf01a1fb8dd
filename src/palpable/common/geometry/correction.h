/// @file
/// When a loop is closed, the poses of earlier keyframes change. Things that were placed in the
/// world by the old poses are moved by one correction for each keyframe.
#pragma once

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/rigid.h"

#include <algorithm>
#include <span>

namespace palpable {

struct Correction {
  int keyframe = 0;  ///< number of its frame
  /// Maps a point that was placed by this keyframe's drifted pose to its corrected position.
  Rigid3 world_from_drifted = Rigid3::Identity();
};

/// The correction for things that were placed in frame `number`: that of the last keyframe up to
/// this frame, or that of the first keyframe if there is none.
/// @param corrections  at least one, their numbers rising
[[nodiscard]] inline const Rigid3& correction_at(std::span<const Correction> corrections,
                                                 int number) {
  PALPABLE_EXPECT(!corrections.empty(), "something was corrected");
  const auto after = std::upper_bound(corrections.begin(), corrections.end(), number,
                                      [](int n, const Correction& c) { return n < c.keyframe; });
  return (after == corrections.begin() ? after : after - 1)->world_from_drifted;
}

}  // namespace palpable
