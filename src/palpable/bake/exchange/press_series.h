/// @file
/// Writes the presses of a body as series that ParaView plays: one per site, with the load level as
/// time.
#pragma once

#include "palpable/common/reduced/reduced_body.h"

#include <filesystem>
#include <optional>

namespace palpable {

/// Writes a folder with a .vtu per site and level and a .pvd per site: displacement (m), Cauchy
/// stress and von Mises stress (Pa) at the nodes of the body's volume, or of its surface if the
/// file has no volume.
/// @param site  only this one
/// @throws Error if something cannot be written
/// @pre body.is_settled()
void write_vtu_series(const std::filesystem::path& folder, const ReducedBody& body,
                      std::optional<int> site = {});

/// Writes the same as one XDMF file, with the numbers in an HDF5 file beside it (.h5 added to the
/// name).
void write_xdmf_series(const std::filesystem::path& path, const ReducedBody& body,
                       std::optional<int> site = {});

}  // namespace palpable
