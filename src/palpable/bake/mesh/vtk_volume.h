/// @file
/// Tetrahedral meshes in VTK's files (.vtu, .vtk).
#pragma once

#include "palpable/bake/mesh/volume_mesh.h"
#include "palpable/common/base/error.h"

#include <filesystem>

namespace palpable {

/// Reads the tetrahedra (cells 10 or 24) of an unstructured grid; fields are ignored, and the
/// format has no sets. Points are numbered from 0. Lines, triangles and points that no tetrahedron
/// uses are dropped, other solids refused.
[[nodiscard]] Result<VolumeMesh> read_vtk_volume(const std::filesystem::path& path);

}  // namespace palpable
