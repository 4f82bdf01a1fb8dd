/// @file
/// Files that say at once when the disk does not take them. A stream of the standard library says
/// it when its buffer happens to be full, or when it is closed, or, closed by its destructor,
/// never.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace palpable {

/// A file that grows piece by piece. Each piece is in it as a whole or not at all: on a full disk
/// the file ends with the piece before, so that what was written can be read.
class GrowingFile {
 public:
  /// Begins the file anew. @throws Error "FILE: cannot be written: REASON", as the others do
  explicit GrowingFile(const std::filesystem::path& path) : GrowingFile(path, path) {}
  /// @param called  what messages call it, for a file that is to become that one
  GrowingFile(const std::filesystem::path& path, std::filesystem::path called);
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  ~GrowingFile();

  /// With the system after this call: it outlives the program, killed or not.
  void append(std::string_view piece);
  void close();

 private:
  std::filesystem::path called_;
  int descriptor_ = -1;  // -1: closed
  std::int64_t size_ = 0;
};

}  // namespace palpable
