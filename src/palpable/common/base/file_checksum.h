/// @file
/// A checksum that shows whether a file has changed.
#pragma once

#include "palpable/common/base/error.h"

#include <cstdint>
#include <filesystem>

namespace palpable {

/// The checksum (word_hash.h) of a file's bytes, read piece by piece; takes 0.1 s for 200 MB that
/// the system has in memory. The problem is a reason without the file's name, for the caller's
/// message.
[[nodiscard]] Result<std::uint64_t> file_checksum(const std::filesystem::path& path);

}  // namespace palpable
