/// @file
/// The presses of a body as series that ParaView plays: one per site, its load level as the time.
#pragma once

#include "palpable/reduced/reduced_body.h"

#include <filesystem>
#include <optional>

namespace palpable {

/// A folder with a .vtu per site and level and a .pvd per site. Displacement (m), Cauchy stress and
/// von Mises stress (Pa) at the nodes of the inside, where the body has one, else of the surface.
/// @param site  only this one
/// @throws Error if something cannot be written
/// @pre body.is_settled()
void write_vtu_series(const std::filesystem::path& folder, const ReducedBody& body,
                      std::optional<int> site = {});

/// The same as one XDMF file and one of HDF5 beside it (with .h5 added to its name).
void write_xdmf_series(const std::filesystem::path& path, const ReducedBody& body,
                       std::optional<int> site = {});

}  // namespace palpable
