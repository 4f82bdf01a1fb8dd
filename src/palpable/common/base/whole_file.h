/// @file
/// All bytes of a file, or why they are not to be had.
#pragma once

#include "palpable/common/base/error.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace palpable {

/// Reads a file into memory. One that memory cannot hold is a problem before it is read: a film
/// called mesh.stl by mistake has gigabytes.
///
/// The problem is a reason without the file's name, for the caller's sentence: "no such file" (or
/// no ordinary one), "cannot be read", "5000 MB are more than there is memory for", "5000 MB, where
/// 16 are read at most".
/// @param most  bytes
[[nodiscard]] Result<std::string> read_whole_file(
    const std::filesystem::path& path,
    std::uintmax_t most = std::numeric_limits<std::uintmax_t>::max());

}  // namespace palpable
