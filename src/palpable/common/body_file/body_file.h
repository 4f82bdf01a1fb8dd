/// @file
/// Reads and writes body files, which the bake half writes and the live half reads: a ReducedBody
/// in HDF5. Layout: docs/body_file.md. Several threads may read and write body files at the same
/// time: HDF5 itself, which is not thread-safe, is used by one at a time.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/reduced/reduced_body.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace palpable {

/// Version of the layout that this program writes. Every later program will read it. 0 was
/// provisional.
inline constexpr int kBodyFileVersion = 1;

/// How the names of body files end.
inline constexpr std::string_view kBodyFileEnding = ".palpable";

enum class ModeStorage {
  kFloat32,  ///< as in evaluation
  kFloat16   ///< half the bytes, each mode scaled to fit; for the error see ReductionError
};

/// Reads and checks a body file. For any bytes, the result is a body that satisfies every rule of
/// reduced_body.h, or a problem that names the file and its error. Parameters beyond site and level
/// remain parameters; the frame loop needs a body that is settled().
[[nodiscard]] Result<ReducedBody> read_body_file(const std::filesystem::path& path);

/// The same, settled, as the live half needs it. @param values see settled()
[[nodiscard]] Result<ReducedBody> read_pressable_body(
    const std::filesystem::path& path, const std::map<std::string, double>& values = {});

/// Writes a body file under another name, syncs it, and renames it: a reader sees the old file or
/// the complete new one. Calls tabulate_press() for a body without depth_slope and level_slope.
/// @throws Error if the file cannot be written (missing folder, full disk)
/// @return the body's errors as the file states them, including those of rounding
ReductionError write_body_file(const std::filesystem::path& path, const ReducedBody& body,
                               ModeStorage storage = ModeStorage::kFloat32);

}  // namespace palpable
