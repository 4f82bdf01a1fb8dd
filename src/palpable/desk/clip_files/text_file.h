/// @file
/// Text files line by line: what the formats of this module that are text have in common.
#pragma once

#include "palpable/common/base/growing_file.h"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace palpable {

/// A text file that is written line by line and reports a full disk instead of staying short. On
/// the disk it always ends with a whole line.
class TextFile {
 public:
  /// Begins the file anew. @throws Error "FILE: cannot be written: REASON", as the others do
  explicit TextFile(const std::filesystem::path& path) : file_(path) {}
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  /// What is not on the disk yet goes there if it can. Who wants to know calls close().
  ~TextFile();

  /// Whole lines. They are kept until there are many, or until flush().
  void write(std::string_view lines);
  void flush();
  void close();

 private:
  GrowingFile file_;
  std::string kept_;
};

/// Hands over the lines that are not empty, without their ends (LF or CRLF).
/// @throws Error "FILE: cannot be read"; what `read_line` throws as Error gets "FILE: line N: " in
/// front
void for_each_line(const std::filesystem::path& path,
                   const std::function<void(const std::string& line)>& read_line);

}  // namespace palpable
