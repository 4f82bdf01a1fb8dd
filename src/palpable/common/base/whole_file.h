/// @file
/// Reads all bytes of a file within a bound, or a given number of bytes from a pipe.
///
/// Every reader that keeps a whole file in memory reads it here: first the first bytes, which tell
/// whether it is the right kind of file and how large it says it is, then the rest.
#pragma once

#include "palpable/common/base/error.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace palpable {

/// How many of a file's first bytes are judged before the rest is read.
inline constexpr std::size_t kJudgedBytes = 1 << 16;

/// What a file must be for its bytes to be read.
struct FileBound {
  std::uintmax_t most;  ///< largest size that is read, bytes; the reader says why

  /// What to do about a larger file; ends the message.
  std::string_view remedy = "is it the file that was meant?";

  /// What is wrong with a file, judged by its first bytes (kJudgedBytes of them, or the whole
  /// file if it is smaller) and its size; empty: nothing. A file of the wrong kind is refused as
  /// such, even if it is also too large.
  std::function<std::string(std::string_view first, std::uintmax_t size)> why_not = {};
};

/// Why a path is not a file that can be read: "no such file", "is a folder", "is no regular file: a
/// pipe or a device is not read"; empty if it is one. A pipe would block its reader for ever, a
/// device may never end.
[[nodiscard]] std::string why_no_file(const std::filesystem::path& path);

/// Reads a file into memory.
///
/// The problem is a reason without the file's name, for the caller's message: that of
/// why_no_file(), that of `why_not`, "cannot be read", "5000 MB, where 16 are read at most; ..." or
/// "5000 MB are more than there is memory for".
[[nodiscard]] Result<std::string> read_whole_file(const std::filesystem::path& path,
                                                  const FileBound& bound);

/// Like read_whole_file() for a text, which becomes a plain_text().
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& path,
                                                 const FileBound& bound);

/// Reads from a file descriptor until `bytes` is full; continues after a signal or an empty pipe
/// has cut a read short. False at the end of the data or at an error.
[[nodiscard]] bool read_all(int descriptor, std::span<std::byte> bytes);

}  // namespace palpable
