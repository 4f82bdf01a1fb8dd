/// @file
/// Formats of two files: a light one in XML, and beside it a heavy one in HDF5, to which the light
/// one refers.
#pragma once

#include <filesystem>
#include <functional>
#include <hdf5.h>
#include <string>

namespace palpable {

/// The path of the heavy file of a light one: "a.xdmf" has "a.xdmf.h5" beside it. The user does not
/// name that file, so an existing one is replaced only where the light file that refers to it
/// exists as well.
/// @throws Error for an existing heavy file without its light file
[[nodiscard]] std::filesystem::path heavy_beside(const std::filesystem::path& light);

/// Writes both files; where one cannot be written, both keep their earlier content.
/// @param fill   fills the heavy file
/// @param light  the text of the light file; read when `fill` has returned
/// @throws Error naming the file that cannot be written, or whose name XML cannot hold
void write_heavy_and_light(const std::filesystem::path& heavy,
                           const std::function<void(hid_t file)>& fill,
                           const std::filesystem::path& light_path, const std::string& light);

}  // namespace palpable
