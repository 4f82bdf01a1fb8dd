/// @file
/// Reads all bytes of a file, or a given number of bytes from a pipe.
#pragma once

#include "palpable/common/base/error.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>

namespace palpable {

/// Reads a file into memory. A file that does not fit into memory, such as a film that is called
/// mesh.stl by mistake, gives a problem before it is read.
///
/// The problem is a reason without the file's name, for the caller's message: "no such file" (also
/// for what is not a regular file), "cannot be read", "5000 MB are more than there is memory for",
/// "5000 MB, where 16 are read at most".
/// @param most  largest size that is read, bytes
[[nodiscard]] Result<std::string> read_whole_file(
    const std::filesystem::path& path,
    std::uintmax_t most = std::numeric_limits<std::uintmax_t>::max());

/// Reads from a file descriptor until `bytes` is full; continues after a signal or an empty pipe
/// has cut a read short. False at the end of the data or at an error.
[[nodiscard]] bool read_all(int descriptor, std::span<std::byte> bytes);

}  // namespace palpable
