/// @file
/// The scores against truth/deformed: where the drawn skin lies, its stress, the felt force.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/score/spread.h"
#include "palpable/desk/scorecard/folders.h"

#include <optional>
#include <vector>

namespace palpable {

/// Of a frame that is 4 mm deep or more, and seen; by the names of docs/benchmark.md. Nothing is
/// what the result does not say.
struct DeformedFrame {
  int frame = 0;
  std::optional<double> displacement_error, displacement_error_mm, von_mises_error, force_error;
};

/// By the names of docs/benchmark.md; nothing without a truth of that kind.
struct DeformedScores {
  std::optional<int> deformed_frames;          ///< with such a truth, 4 mm deep or more, and seen
  std::optional<int> deformed_frames_shallow;  ///< less deep, and seen
  std::optional<int> deformed_frames_unseen;   ///< whose touch no camera sees: not judged
  std::optional<MedianAndP90> displacement_error;
  std::optional<MedianAndP90> displacement_error_mm;
  std::optional<MedianAndP90> displacement_error_mm_shallow;
  std::optional<MedianAndP90> displacement_error_mm_unseen;
  std::optional<MedianAndP90> von_mises_error;
  std::optional<MedianAndP90> force_error;
  std::optional<P50AndP99> overpress_mm;
  std::vector<DeformedFrame> frames;  ///< of which displacement, stress and force are told above
};

/// A figure is nothing when it is not known of some frame, which might be the worst. A frame that
/// was not processed has an answer: the body at rest, without a touch. So leaving out hard frames
/// gains nothing.
/// @param body  of the run; may be null
/// @throws Error as DrawnSkins, and naming the true skin that cannot be read
[[nodiscard]] DeformedScores score_deformed(const TruthFolder& truth, const ResultFolder& result,
                                            const ReducedBody* body);

}  // namespace palpable
