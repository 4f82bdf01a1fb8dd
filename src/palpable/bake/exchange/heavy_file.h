/// @file
/// Formats of two files: a light one that is XML, and a heavy one beside it, HDF5, to which it
/// refers.
#pragma once

#include <filesystem>
#include <functional>
#include <hdf5.h>
#include <string>

namespace palpable {

/// Where the heavy one of a light one goes: "a.xdmf" has "a.xdmf.h5" beside it. Nobody names that
/// file, so one that is there is replaced only beside the light one that refers to it.
/// @throws Error for one of somebody's
[[nodiscard]] std::filesystem::path heavy_beside(const std::filesystem::path& light);

/// Writes both; where one cannot be written, both stay what they were.
/// @param fill   fills the heavy one
/// @param light  the text of the light one; read when `fill` has returned
/// @throws Error naming the file that cannot be written, or whose name XML cannot hold
void write_heavy_and_light(const std::filesystem::path& heavy,
                           const std::function<void(hid_t file)>& fill,
                           const std::filesystem::path& light_path, const std::string& light);

}  // namespace palpable
