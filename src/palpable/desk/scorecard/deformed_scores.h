/// @file
/// The scores against truth/deformed: the shape of the drawn skin, its stress, and the felt force.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/score/statistics.h"
#include "palpable/desk/scorecard/folders.h"

#include <optional>
#include <vector>

namespace palpable {

/// The scores of one frame with a touch that is seen and at least 4 mm deep, named as in
/// docs/benchmark.md. Values that the result does not give are nothing.
struct DeformedFrame {
  int frame = 0;
  std::optional<double> displacement_error, displacement_error_mm, von_mises_error, force_error;
};

/// Scores named as in docs/benchmark.md; nothing without truth/deformed.
struct DeformedScores {
  std::optional<int> deformed_frames;          ///< scored frames, seen and >= 4 mm deep
  std::optional<int> deformed_frames_shallow;  ///< scored frames, seen and < 4 mm deep
  std::optional<int> deformed_frames_unseen;   ///< touch not seen: only counted
  std::optional<MedianAndP90> displacement_error;
  std::optional<MedianAndP90> displacement_error_mm;
  std::optional<MedianAndP90> displacement_error_mm_shallow;
  std::optional<MedianAndP90> displacement_error_mm_unseen;
  std::optional<MedianAndP90> von_mises_error;
  std::optional<MedianAndP90> force_error;
  std::optional<P50AndP99> overpress_mm;
  std::vector<DeformedFrame> frames;  ///< those of deformed_frames
};

/// If the result lacks a value in some frame, which might be the worst one, the score is nothing. A
/// frame that was not processed counts as the body at rest without a touch. So a result cannot gain
/// by leaving out hard frames.
/// @param body  reduced body of the run; may be null
/// @throws Error as DrawnSkins does, and naming a true skin that cannot be read
[[nodiscard]] DeformedScores score_deformed(const TruthFolder& truth, const ResultFolder& result,
                                            const ReducedBody* body);

}  // namespace palpable
