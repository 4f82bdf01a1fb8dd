/// @file
/// Response of a body's tables of touch to the true hand of a synthetic clip, without a camera's
/// errors: the errors that remain when the hand, or only its visible side, is known exactly.
#pragma once

#include "palpable/common/response/touchable_body.h"

#include <filesystem>
#include <vector>

namespace palpable {

/// Errors of the response in one frame.
struct ClipFrame {
  int frame = 0;
  double displacement = 0;  ///< relative L2 over the skin
  double worst_vertex_mm = 0;
  double force = 0;      ///< of the resultant, relative
  double von_mises = 0;  ///< error of the worst vertex / largest stress
};

struct ClipResult {
  std::vector<ClipFrame> frames;     ///< scored frames that are deep enough, in their order
  std::vector<double> milliseconds;  ///< of all frames with an obstacle nearby
  int unseen = 0;                    ///< skipped frames: no camera sees the touching part (kDepth)
  double largest_jump_mm = 0;        ///< of a vertex between two successive frames
};

/// The obstacle.
enum class TrueHand {
  kCapsules,  ///< the hand's own capsules
  kDepth,     ///< as a perfect depth camera measures it, hidden side assumed as in `live`
};

/// Plays all frames of the clip and compares with CLIP/truth/deformed (written by
/// `palpable truth`).
/// @param body   with tables; the body of the clip
/// @param depth  m, penetration of the undeformed body; shallower frames are not compared
/// @throws Error naming a file that is missing or belongs to another body
[[nodiscard]] ClipResult compare_with_true_hand(const TouchableBody& body,
                                                const std::filesystem::path& clip, TrueHand hand,
                                                double depth);

}  // namespace palpable
