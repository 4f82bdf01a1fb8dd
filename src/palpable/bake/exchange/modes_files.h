/// @file
/// Files of separated representations that other programs write and read: a folder of NumPy arrays,
/// and PXDMF, a format of the PGD community (XDMF with one grid per space). docs/exchange.md
/// describes both.
#pragma once

#include "palpable/bake/exchange/foreign_modes.h"

#include <filesystem>

namespace palpable {

/// @param folder  created if it does not exist
/// @throws Error if something cannot be written
void write_numpy_modes(const std::filesystem::path& folder, const ForeignModes& modes);

/// @throws Error that names the array that is missing or does not fit
[[nodiscard]] ForeignModes read_numpy_modes(const std::filesystem::path& folder);

/// Writes `path` (.pxdmf), and its numbers to a file beside it with .h5 added to the name.
/// @throws Error if one of them cannot be written
void write_pxdmf(const std::filesystem::path& path, const ForeignModes& modes);

/// Reads numbers from HDF5 or from the XML itself. The grid of triangles is the space. Every other
/// grid is one parameter; it is a choice if its points are unconnected (Polyvertex).
/// @throws Error that names what is missing or cannot be read
[[nodiscard]] ForeignModes read_pxdmf(const std::filesystem::path& path);

}  // namespace palpable
