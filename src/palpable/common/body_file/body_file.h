/// @file
/// The one file that joins the halves: a ReducedBody in HDF5. Layout: docs/body_file.md.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/reduced/reduced_body.h"

#include <filesystem>
#include <map>
#include <string>

namespace palpable {

/// Version of the layout that this program writes and every later one will read. 0 was provisional.
inline constexpr int kBodyFileVersion = 1;

enum class ModeStorage {
  kFloat32,  ///< as they are evaluated
  kFloat16   ///< half the bytes; each mode scaled to fit. What that costs is in ReductionError
};

/// Reads and checks a body file. Whatever the bytes, the result is a body that keeps every promise
/// of reduced_body.h or a problem that names the file and what is wrong with it. Parameters beyond
/// site and level stay parameters: the frame loop asks for a body that is settled().
[[nodiscard]] Result<ReducedBody> read_body_file(const std::filesystem::path& path);

/// The same, settled: what the live half presses. @param values see settled()
[[nodiscard]] Result<ReducedBody> read_pressable_body(
    const std::filesystem::path& path, const std::map<std::string, double>& values = {});

/// Writes a body file aside, syncs it, and renames it into place: a reader sees the old file or the
/// whole new one. @throws Error when the file cannot be written (missing folder, full disk).
/// The press is tabulated if it is not.
/// @return the body's errors as the file states them, those of rounding included
ReductionError write_body_file(const std::filesystem::path& path, const ReducedBody& body,
                               ModeStorage storage = ModeStorage::kFloat32);

}  // namespace palpable
