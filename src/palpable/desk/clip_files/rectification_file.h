/// @file
/// rectification.jsonl of a result: the corrections of a rig that lost its alignment, one line per
/// change:
///
///     {"frame":150,"row_correction_px":0.5120,"row_error_px":0.0312}
///
/// From this frame on the right image is moved up by row_correction_px rows of the full-size
/// picture, in addition to the rectification by the calibration. row_error_px remains in this
/// frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct CorrectionLine {
  int frame = 0;
  double row_correction_px = 0;
  std::optional<double> row_error_px;  ///< remaining error; nothing: too few points
};

/// One line, including its line end.
[[nodiscard]] std::string correction_line(const CorrectionLine& correction);

/// @throws Error naming file and line when frame numbers do not increase or a correction is no
/// number
[[nodiscard]] std::vector<CorrectionLine> read_corrections(const std::filesystem::path& path);

}  // namespace palpable
