/// @file
/// rig.jsonl of a truth: the misalignment of the rig, one line per frame:
///
///     {"frame":7,"row_offset_px":0.0700}
///     {"frame":8,"row_offset_px":0.5700,"step":true}
///
/// The right image lies row_offset_px rows of the full-size picture lower than the calibration
/// says. "step": the offset jumped in this frame.
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

/// One line, including its line end.
[[nodiscard]] std::string rig_line(const RigLine& rig);

/// @throws Error naming file and line when frame numbers do not increase or an offset is no number
[[nodiscard]] std::vector<RigLine> read_rig(const std::filesystem::path& path);

}  // namespace palpable
