/// @file
/// The answer of a body's tables of touch to the true hand of a filmed clip: what is left when
/// everything is seen exactly.
#pragma once

#include "palpable/touch/touchable_body.h"

#include <filesystem>
#include <vector>

namespace palpable {

/// Of the frames that are scored and at least so deep, in their order.
struct ClipAnswer {
  std::vector<int> frames;
  std::vector<double> displacement;  ///< relative L2 over the skin
  std::vector<double> worst_vertex_mm;
  std::vector<double> force;         ///< of the resultant, relative
  std::vector<double> von_mises;     ///< worst vertex against the largest
  std::vector<double> milliseconds;  ///< of all frames in which something is near
  double largest_jump_mm = 0;        ///< of a vertex, from any frame to the next
};

/// Plays all frames of the clip, the hand's capsules as the obstacle, and compares with
/// CLIP/truth/deformed (`palpable truth` writes it).
/// @param body   with tables; the one that was filmed
/// @param depth  m: of the undeformed body; shallower frames are not compared
/// @throws Error naming the file that is missing or of another body
[[nodiscard]] ClipAnswer answer_to_true_hand(const TouchableBody& body,
                                             const std::filesystem::path& clip, double depth);

}  // namespace palpable
