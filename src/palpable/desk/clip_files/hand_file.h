/// @file
/// hand.jsonl of a truth: all that moves, a line per frame,
///
///     {"frame":7,"capsules":[[ax,ay,az,bx,by,bz,ra,rb],...]}
///
/// in metres, in the camera's frame of that frame.
#pragma once

#include "palpable/common/geometry/capsule.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

struct HandLine {
  int frame = 0;
  std::vector<Capsule> capsules;
};

/// One line, its end included.
[[nodiscard]] std::string hand_line(const HandLine& hand);

/// @throws Error naming file and line when frames do not rise, when a capsule is not eight numbers
/// or when a radius is negative
[[nodiscard]] std::vector<HandLine> read_hands(const std::filesystem::path& path);

}  // namespace palpable
