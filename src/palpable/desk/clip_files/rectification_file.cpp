#include "palpable/desk/clip_files/rectification_file.h"

#include "palpable/desk/clip_files/json_lines.h"

#include <fmt/core.h>

namespace palpable {

std::string correction_line(const CorrectionLine& correction) {
  return fmt::format(
      "{{\"frame\":{},\"row_correction_px\":{:.4f},\"row_error_px\":{}}}\n", correction.frame,
      correction.row_correction_px,
      correction.row_error_px ? fmt::format("{:.4f}", *correction.row_error_px) : "null");
}

std::vector<CorrectionLine> read_corrections(const std::filesystem::path& path) {
  std::vector<CorrectionLine> corrections;
  for_each_object(path, [&](const JsonObject& line) {
    const int frame = line.frame_after(corrections.empty() ? -1 : corrections.back().frame);
    corrections.push_back(
        {frame, line.number("row_correction_px"), line.number_if_any("row_error_px")});
  });
  return corrections;
}

}  // namespace palpable
