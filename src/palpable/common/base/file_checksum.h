/// @file
/// Whether a file is still the one that it was.
#pragma once

#include "palpable/common/base/error.h"

#include <cstdint>
#include <filesystem>

namespace palpable {

/// The checksum (word_hash.h) of a file's bytes, read piece by piece: 0.1 s for 200 MB that are in
/// memory. The problem is a reason without the file's name, for the caller's sentence.
[[nodiscard]] Result<std::uint64_t> file_checksum(const std::filesystem::path& path);

}  // namespace palpable
