/// @file
/// Further groups of a body file, of modules above this one: what they know of a body beyond
/// ReducedBody. The file's checksum covers them, and a reader that does not know a group skips it.
#pragma once

#include "palpable/common/body_file/body_file.h"

#include <filesystem>
#include <functional>
#include <hdf5.h>

namespace palpable {

/// Puts groups into the file, beside those of docs/body_file.md. May throw hdf5::Trouble.
using WriteGroups = std::function<void(hid_t file)>;

/// Reads groups of a file whose checksum and body are right. Throws hdf5::Trouble for a group that
/// is not: then the file is one that cannot be read.
using ReadGroups = std::function<void(hid_t file, const ReducedBody& body)>;

/// write_body_file() with further groups. @throws Error as that, and for what `further` throws
ReductionError write_body_file(const std::filesystem::path& path, const ReducedBody& body,
                               ModeStorage storage, const WriteGroups& further);

/// read_body_file() that shows the file to `further`, too: one reading, one checksum.
[[nodiscard]] Result<ReducedBody> read_body_file(const std::filesystem::path& path,
                                                 const ReadGroups& further);

}  // namespace palpable
