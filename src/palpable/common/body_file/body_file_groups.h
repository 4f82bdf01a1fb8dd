/// @file
/// Further groups of a body file, which modules above this one write and read: data of a body
/// beyond ReducedBody. The file's checksum covers them, and a reader that does not know a group
/// skips it.
#pragma once

#include "palpable/common/body_file/body_file.h"

#include <filesystem>
#include <functional>
#include <hdf5.h>

namespace palpable {

/// Writes groups into the file, beside those of docs/body_file.md. May throw hdf5::Trouble.
using WriteGroups = std::function<void(hid_t file)>;

/// Reads groups of a file whose checksum and body are valid. Throws hdf5::Trouble for an invalid
/// group; then reading the file fails.
using ReadGroups = std::function<void(hid_t file, const ReducedBody& body)>;

/// write_body_file() with further groups. @throws Error as that, and for what `further` throws
ReductionError write_body_file(const std::filesystem::path& path, const ReducedBody& body,
                               ModeStorage storage, const WriteGroups& further);

/// read_body_file() that also calls `further`, so that the file is read and checked only once.
[[nodiscard]] Result<ReducedBody> read_body_file(const std::filesystem::path& path,
                                                 const ReadGroups& further);

}  // namespace palpable
