/// @file
/// What a closed loop says of the way that was thought to be known: keyframe by keyframe, where
/// what was placed by it really lies.
#pragma once

#include "palpable/base/contract.h"
#include "palpable/geometry/rigid.h"

#include <algorithm>
#include <span>

namespace palpable {

struct Correction {
  int keyframe = 0;  ///< number of its frame
  /// Takes what was placed by this keyframe to where it lies.
  Rigid3 world_from_drifted = Rigid3::Identity();
};

/// The correction for what was placed in frame `number`: the last keyframe's before it, or the
/// first one's.
/// @param corrections  at least one, their numbers rising
[[nodiscard]] inline const Rigid3& correction_at(std::span<const Correction> corrections,
                                                 int number) {
  PALPABLE_EXPECT(!corrections.empty(), "something was corrected");
  const auto after = std::upper_bound(corrections.begin(), corrections.end(), number,
                                      [](int n, const Correction& c) { return n < c.keyframe; });
  return (after == corrections.begin() ? after : after - 1)->world_from_drifted;
}

}  // namespace palpable
