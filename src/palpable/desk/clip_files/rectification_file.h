/// @file
/// rectification.jsonl of a result: how a rig that went out of alignment was put right, a line for
/// each change,
///
///     {"frame":150,"row_correction_px":0.5120,"row_error_px":0.0312}
///
/// From this frame on the right image was moved up by so many rows of the full-size picture beyond
/// what the calibration says.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct CorrectionLine {
  int frame = 0;
  double row_correction_px = 0;
  std::optional<double> row_error_px;  ///< left in this frame; nothing: too few points to say
};

/// One line, its end included.
[[nodiscard]] std::string correction_line(const CorrectionLine& correction);

/// @throws Error naming file and line when frames do not rise or a correction is no number
[[nodiscard]] std::vector<CorrectionLine> read_corrections(const std::filesystem::path& path);

}  // namespace palpable
