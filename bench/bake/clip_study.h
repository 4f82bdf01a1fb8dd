/// @file
/// The answer of a body's tables of touch to the true hand of a filmed clip, without a camera's
/// errors: what is left when the hand is known exactly, or when only its front is.
#pragma once

#include "palpable/common/response/touchable_body.h"

#include <filesystem>
#include <vector>

namespace palpable {

/// How far the answer is off in a frame.
struct ClipFrame {
  int frame = 0;
  double displacement = 0;  ///< relative L2 over the skin
  double worst_vertex_mm = 0;
  double force = 0;      ///< of the resultant, relative
  double von_mises = 0;  ///< worst vertex against the largest
};

struct ClipResult {
  std::vector<ClipFrame> frames;     ///< those that are scored and deep enough, in their order
  std::vector<double> milliseconds;  ///< of all frames in which something is near
  int unseen = 0;                    ///< frames left out: no camera sees what touches (kDepth)
  double largest_jump_mm = 0;        ///< of a vertex, from any frame to the next
};

/// What presses.
enum class TrueHand {
  kCapsules,  ///< the hand itself
  kDepth,     ///< what a perfect depth camera sees of it, its other side assumed as live does
};

/// Plays all frames of the clip and compares with CLIP/truth/deformed (`palpable truth` writes it).
/// @param body   with tables; the one that was filmed
/// @param depth  m: of the undeformed body; shallower frames are not compared
/// @throws Error naming the file that is missing or of another body
[[nodiscard]] ClipResult compare_with_true_hand(const TouchableBody& body,
                                                const std::filesystem::path& clip, TrueHand hand,
                                                double depth);

}  // namespace palpable
