/// @file
/// A hands file (*.jsonl): what presses, frame by frame, without a camera. Each line is one of
/// session/things_line.h.
#pragma once

#include "palpable/desk/clip_files/text_file.h"
#include "palpable/live/session/things_line.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// Reads a hands file line by line; one line is in memory at a time.
class ThingsFile {
 public:
  /// @throws Error naming the file if it cannot be read
  explicit ThingsFile(const std::filesystem::path& path) : lines_(path) {}

  /// Reads the next line. Empty lines are skipped. @return false at the end of the file
  /// @throws Error "FILE: line N: ..." for a line that is none, or whose time does not grow
  bool next(ThingsLine& line);

 private:
  LineReader lines_;
  std::string text_;
  std::optional<double> time_;  // s, of the line before
};

}  // namespace palpable
