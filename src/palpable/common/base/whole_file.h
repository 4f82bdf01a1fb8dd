/// @file
/// Reads all bytes of a file.
#pragma once

#include "palpable/common/base/error.h"

#include <cstdint>
#include <filesystem>
#include <limits>
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

}  // namespace palpable
