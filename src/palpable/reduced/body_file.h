/// @file
/// The one file that joins the halves: a ReducedBody in HDF5. Layout: docs/body_file.md.
#pragma once

#include "palpable/base/error.h"
#include "palpable/reduced/reduced_body.h"

#include <filesystem>

namespace palpable {

/// Version of the layout that this program writes; it reads this one only. 0 is provisional.
inline constexpr int kBodyFileVersion = 0;

/// Reads and checks a body file. Whatever the bytes, the result is a body that keeps every promise
/// of reduced_body.h or a problem that names the file and what is wrong with it.
[[nodiscard]] Result<ReducedBody> read_body_file(const std::filesystem::path& path);

/// Writes a body file aside, syncs it, and renames it into place: a reader sees the old file or the
/// whole new one. @throws Error when the file cannot be written (missing folder, full disk).
void write_body_file(const std::filesystem::path& path, const ReducedBody& body);

}  // namespace palpable
