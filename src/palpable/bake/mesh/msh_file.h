/// @file
/// Tetrahedral meshes in Gmsh's .msh text format.
#pragma once

#include "palpable/bake/mesh/volume_mesh.h"
#include "palpable/common/base/error.h"

#include <filesystem>
#include <string_view>

namespace palpable {

/// Reads the tetrahedra (4 or 10 nodes, all alike) of a .msh file, version 2.2 or 4.1, ASCII, with
/// its physical groups as sets: points and curves name nodes, surfaces faces, volumes tetrahedra; a
/// group without a name is named by its number. Other sections are skipped, nodes that no
/// tetrahedron uses are dropped; lengths are not converted. For any input the result is either a
/// mesh with at least one tetrahedron, finite nodes and positive volumes (between the corners), or
/// a problem that names the file, the line, and what is wrong (a tetrahedron by its number in the
/// file). Hexahedra, prisms and pyramids are refused.
[[nodiscard]] Result<VolumeMesh> read_msh_file(const std::filesystem::path& path);

/// The same from memory. @param name  for messages
[[nodiscard]] Result<VolumeMesh> parse_msh(std::string_view text, std::string_view name);

/// Writes version 2.2, ASCII: tetrahedra (physical group "body") and the triangles of the skin
/// ("boundary"), 6-node ones where tetrahedra have ten; all digits kept.
/// @throws Error when the file cannot be written
void write_msh_file(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace palpable
