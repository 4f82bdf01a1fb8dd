/// @file
/// hand.jsonl of a truth: the capsules of all moving things, one line per frame:
///
///     {"frame":7,"capsules":[[ax,ay,az,bx,by,bz,ra,rb],...]}
///
/// Lengths are in metres, in the frame of the camera at that instant.
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

/// One line, including its line end.
[[nodiscard]] std::string hand_line(const HandLine& hand);

/// @throws Error naming file and line when frame numbers do not increase, when a capsule is not
/// eight numbers or when a radius is negative
[[nodiscard]] std::vector<HandLine> read_hands(const std::filesystem::path& path);

}  // namespace palpable
