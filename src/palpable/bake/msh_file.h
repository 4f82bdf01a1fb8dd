/// @file
/// Tetrahedral meshes in Gmsh's .msh text format.
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/tet_mesh.h"

#include <filesystem>
#include <string_view>

namespace palpable {

/// Reads the linear tetrahedra of a .msh file, version 2.2 or 4.1, ASCII. Points, lines, triangles
/// and other sections are skipped, nodes that no tetrahedron uses are dropped; lengths are taken as
/// they stand. Whatever the bytes, the result is a mesh with at least one tetrahedron, finite nodes
/// and positive volumes, or a problem that names the file, the line, and what is wrong (an inverted
/// tetrahedron by its number in the file).
[[nodiscard]] Result<TetMesh> read_msh_file(const std::filesystem::path& path);

/// The same from memory. @param name for messages
[[nodiscard]] Result<TetMesh> parse_msh(std::string_view text, std::string_view name);

/// Writes version 2.2, ASCII: tetrahedra (physical group 1) and the triangles of the boundary
/// (physical group 2), all digits kept. @throws Error when the file cannot be written
void write_msh_file(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace palpable
