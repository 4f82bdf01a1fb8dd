/// @file
/// Files whose write errors, such as a full disk, are reported at once. A stream of the standard
/// library reports them only when its buffer is full or when it is closed, and never if its
/// destructor closes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace palpable {

/// A file that grows piece by piece. Each piece is written as a whole or not at all: on a full disk
/// the file ends with the piece before, so that it can be read.
class GrowingFile {
 public:
  /// Opens the file and empties it. @throws Error "FILE: cannot be written: REASON", as all members
  explicit GrowingFile(const std::filesystem::path& path) : GrowingFile(path, path) {}
  /// @param called  the file's name in messages: that to which it will be renamed later
  GrowingFile(const std::filesystem::path& path, std::filesystem::path called);
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  ~GrowingFile();

  /// After this call the operating system has the piece, so that it survives even if the program is
  /// killed.
  void append(std::string_view piece);
  void close();

 private:
  std::filesystem::path called_;
  int descriptor_ = -1;  // -1: closed
  std::int64_t size_ = 0;
};

}  // namespace palpable
