/// @file
/// rig.jsonl of a truth: how far the rig is out of alignment, a line per frame,
///
///     {"frame":7,"row_offset_px":0.0700}
///     {"frame":8,"row_offset_px":0.5700,"step":true}
///
/// The right image lies so many rows of the full-size picture below what the calibration says;
/// "step": it jumped in this frame.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

struct RigLine {
  int frame = 0;
  double row_offset_px = 0;
  bool step = false;
};

/// One line, its end included.
[[nodiscard]] std::string rig_line(const RigLine& rig);

/// @throws Error naming file and line when frames do not rise or an offset is no number
[[nodiscard]] std::vector<RigLine> read_rig(const std::filesystem::path& path);

}  // namespace palpable
