/// @file
/// Writing and reading of text files line by line, as all text formats of this module need it.
#pragma once

#include "palpable/common/base/output_file.h"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace palpable {

/// A text file that is written line by line. A full disk is reported, not ignored, and the file on
/// the disk always ends with a whole line.
class TextFile {
 public:
  /// Creates or empties the file. @throws Error "FILE: cannot be written: REASON", as write(),
  /// flush() and close() do
  explicit TextFile(const std::filesystem::path& path) : file_(path) {}
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  /// Writes the remaining lines if possible and ignores errors; call close() to have them reported.
  ~TextFile();

  /// Adds whole lines. They are kept in memory until there are 64 KB of them, or until flush().
  void write(std::string_view lines);
  void flush();
  void close();

 private:
  GrowingFile file_;
  std::string kept_;
};

/// Calls `read_line` for each line that is not empty, without its end (LF or CRLF).
/// @throws Error "FILE: cannot be read"; an Error that `read_line` throws is rethrown with the
/// prefix "FILE: line N: "
void for_each_line(const std::filesystem::path& path,
                   const std::function<void(const std::string& line)>& read_line);

}  // namespace palpable
