/// @file
/// Separated representations on disk, as other programs write and read them: a folder of NumPy
/// arrays, and PXDMF, the PGD community's own: XDMF with one grid per space. docs/exchange.md says
/// what is where.
#pragma once

#include "palpable/exchange/foreign_modes.h"

#include <filesystem>

namespace palpable {

/// @param folder  made if it is not there
/// @throws Error if something cannot be written
void write_numpy_modes(const std::filesystem::path& folder, const ForeignModes& modes);

/// @throws Error that names the array that is missing or does not fit
[[nodiscard]] ForeignModes read_numpy_modes(const std::filesystem::path& folder);

/// Writes `path` (.pxdmf) and beside it the numbers (with .h5 added to its name).
/// @throws Error if one of them cannot be written
void write_pxdmf(const std::filesystem::path& path, const ForeignModes& modes);

/// Reads numbers in HDF5 or in the XML itself. The space is the grid of triangles; of the others
/// each is one parameter, a choice where its points are unconnected (Polyvertex).
/// @throws Error that names what is missing or not understood
[[nodiscard]] ForeignModes read_pxdmf(const std::filesystem::path& path);

}  // namespace palpable
