/// @file
/// Writing and reading of text files line by line, as all text formats of this module need it.
#pragma once

#include "palpable/common/base/output_file.h"

#include <filesystem>
#include <fstream>
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

/// The lines of a text file, one after the other. A file of any size may be read: one line is in
/// memory at a time.
class LineReader {
 public:
  /// @throws Error "FILE: no such file" and others of why_no_file(), "FILE: cannot be read"
  explicit LineReader(const std::filesystem::path& path);

  /// Reads the next line that is not empty, without its end (LF, CRLF or CR) and without UTF-8's
  /// byte-order mark. @return false at the end of the file
  /// @throws Error "FILE: line N: ..." for a line above 16 MB, a zero byte or UTF-16
  bool next(std::string& line);
  /// "FILE: line N: ", with the number of the last line, for messages about it.
  [[nodiscard]] std::string where() const;

 private:
  std::filesystem::path path_;
  std::ifstream in_;
  int number_ = 0;  // of the last line, from 1 on
};

/// Calls `read_line` for each line that LineReader finds.
/// @throws Error as LineReader; an Error that `read_line` throws is rethrown with the prefix
/// "FILE: line N: "
void for_each_line(const std::filesystem::path& path,
                   const std::function<void(const std::string& line)>& read_line);

}  // namespace palpable
