/// @file
/// Text files line by line: what the formats of this module that are text have in common.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

namespace palpable {

/// A text file that reports a full disk instead of staying short.
class TextFile {
 public:
  /// Begins the file anew. @throws Error when it cannot be written
  explicit TextFile(std::filesystem::path path);
  void write(std::string_view text);
  /// @throws Error when not everything that was written is in the file
  void close();

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
};

/// Hands over the lines that are not empty, without their ends (LF or CRLF).
/// @throws Error "FILE: cannot be read"; what `read_line` throws as Error gets "FILE: line N: " in
/// front
void for_each_line(const std::filesystem::path& path,
                   const std::function<void(const std::string& line)>& read_line);

}  // namespace palpable
