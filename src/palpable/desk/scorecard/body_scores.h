/// @file
/// The scores of one body: when and where touches were felt, how deep the hand reaches into the
/// drawn surface, how that jumps and stands, and its deformation, stress and force against the
/// full-order solutions in truth/deformed.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/score/statistics.h"
#include "palpable/desk/scorecard/folders.h"

#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// The scores of one frame with a touch at least 4 mm deep, named as in docs/benchmark.md. Values
/// that the result does not give are nothing.
struct ReferenceFrame {
  int frame = 0;
  std::optional<double> displacement_error, max_vertex_error_mm, von_mises_error, force_error;
};

/// The scores of the frames with a touch at least 4 mm deep that no camera sees: "unseen" in
/// docs/benchmark.md. Each has the meaning of its namesake in BodyScores.
struct UnseenScores {
  int frames = 0;
  std::optional<MedianAndP90> displacement_error, max_vertex_error_mm, von_mises_error, force_error;
  std::vector<ReferenceFrame> by_frame;  ///< those of `frames`
};

/// Scores named as in docs/benchmark.md; nothing when truth or result lacks the files for them.
struct BodyScores {
  std::string name;  ///< of one of several bodies; empty: there is only one

  // When and where touches were felt; nothing when the truth has no contacts.
  std::optional<int> frames_touching;
  std::optional<double> touch_precision, touch_recall, touch_site_accuracy;
  std::optional<int> first_touch_delay_frames;
  std::optional<double> touch_recall_3mm, touch_false_discovery_5mm;

  // The drawn surface.
  std::optional<int> frames_too_deep;
  std::optional<int> frames_touch_unseen;  ///< with a touch, not too deep, not seen by a camera
  std::optional<double> penetration_median_mm, penetration_p99_mm, penetration_median_mm_unseen;
  std::optional<double> largest_jump_mm;
  std::optional<int> largest_jump_frame, jumps_above_4mm;
  std::optional<MedianAndP90> placement_error_mm;

  // Against truth/deformed; nothing without it.
  std::optional<int> reference_frames;          ///< scored frames, seen and >= 4 mm deep
  std::optional<int> reference_frames_shallow;  ///< scored frames, seen and < 4 mm deep
  std::optional<int> reference_frames_unseen;   ///< scored frames, touch not seen
  std::optional<MedianAndP90> displacement_error, max_vertex_error_mm;
  std::optional<MedianAndP90> max_vertex_error_mm_shallow, max_vertex_error_mm_unseen;
  std::optional<MedianAndP90> von_mises_error, force_error;
  std::optional<P50AndP99> excess_indentation_mm;
  std::vector<ReferenceFrame> by_frame;  ///< those of reference_frames
  std::optional<UnseenScores> unseen;    ///< apart: none of the figures above includes them
};

/// Scores a body. A result cannot gain by leaving out hard frames: a frame that was not processed
/// counts as the body at rest without a touch, and if the result lacks a value in some frame, which
/// might be the worst one, the score is nothing.
///
/// Penetration and pops are nothing when the skin (drawn_skins.h) or pose of some processed frame
/// is not known, and the placement error when a pose of the truth or the result is not known. A
/// frame that was not processed counts in the pose in which the result says it was drawn or else in
/// its true pose; if neither is known, there is no penetration score, but pops are scored.
/// @param body  reduced body of the run; may be null
/// @throws Error as DrawnSkins does, naming a true skin that cannot be read, and when a touch is in
///         a frame that the truth does not have
[[nodiscard]] BodyScores score_body(const TruthFolder& truth, const ResultFolder& result,
                                    const ReducedBody* body);

}  // namespace palpable
