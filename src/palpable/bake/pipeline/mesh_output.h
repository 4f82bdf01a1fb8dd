/// @file
/// Writes a volume mesh in the format that the ending of its name says.
#pragma once

#include "palpable/common/geometry/tet_mesh.h"

#include <array>
#include <filesystem>
#include <string_view>

namespace palpable {

/// Gmsh, VTK, and the decks of Abaqus and CalculiX.
inline constexpr std::array<std::string_view, 3> kMeshEndings{".msh", ".vtu", ".inp"};

/// Writes what read_volume_file() (mesh/volume_mesh.h) reads again, to the last bit. Gmsh's and
/// Abaqus' files also name the skin and the body.
/// @pre the name ends in one of kMeshEndings
/// @throws Error when the file cannot be written
void write_volume_file(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace palpable
