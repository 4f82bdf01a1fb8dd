/// @file
/// Tetrahedral meshes in the input decks of Abaqus and CalculiX (.inp).
#pragma once

#include "palpable/bake/mesh/volume_mesh.h"
#include "palpable/common/base/error.h"

#include <filesystem>
#include <string_view>

namespace palpable {

/// Reads nodes, tetrahedra (C3D4 or C3D10 and their variants such as C3D10M, all of one kind) and
/// sets: *NSET and NSET= name nodes, *ELSET and ELSET= tetrahedra or, of triangular elements (S3,
/// CPS3, M3D6 ...), faces, *SURFACE of TYPE=ELEMENT faces. Sets may be made of earlier sets or of
/// the nodes of elements (*NSET, ELSET=), and may be GENERATEd; a set that is named twice is
/// extended. A surface of elements other than tetrahedra is left out, and refused when it is used
/// (MeshSets::unusable). The mesh may be in one *PART with one *INSTANCE, which
/// may be moved.
///
/// Everything else is skipped: materials, steps, boundary conditions, beams, shells of four nodes,
/// springs. Refused, because skipping them would change the body: solids other than tetrahedra,
/// *SYSTEM and *NCOPY, a second part or instance. Files of *INCLUDE, and of INPUT= in
/// *NODE, *ELEMENT and sets, are read in their places (inp_include.h).
///
/// Lengths are not converted; nodes that no tetrahedron uses are dropped. For any input the result
/// is either a mesh with at least one tetrahedron, finite nodes and positive volumes (between the
/// corners), or a problem that names the file, the line and what is wrong. The format has no end
/// mark, so a file cut off between two lines cannot be told from a smaller mesh.
[[nodiscard]] Result<VolumeMesh> read_inp_file(const std::filesystem::path& path);

/// The same from memory, without the files that it includes. @param name  for messages
[[nodiscard]] Result<VolumeMesh> parse_inp(std::string_view text, std::string_view name);

/// Writes nodes, C3D4 or C3D10 elements (set "BODY"), and the skin as the faces of tetrahedra
/// (surface "BOUNDARY"), for CalculiX and Abaqus; all digits kept.
/// @throws Error when the file cannot be written
void write_inp_file(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace palpable
