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
/// CPS3, M3D6 ...), faces, *SURFACE of TYPE=ELEMENT faces. Sets may be made of sets named before
/// them, of the nodes of elements (*NSET, ELSET=), and GENERATEd; a set named twice grows. A
/// surface of what is no tetrahedron is left out, and refused when it is asked for
/// (MeshSets::unusable). One *PART with one *INSTANCE that stays where it is may stand around all
/// that.
///
/// What is neither is skipped: materials, steps, boundary conditions, beams, shells of four nodes,
/// springs. Refused, since a body without it would be another: solids that are no tetrahedra,
/// *INCLUDE, *SYSTEM and *NCOPY, instances that are moved.
///
/// Lengths are taken as they stand; nodes that no tetrahedron uses are dropped. Whatever the bytes,
/// the result is a mesh with at least one tetrahedron, finite nodes and positive volumes (between
/// the corners), or a problem that names the file, the line and what is wrong. The format has no
/// end mark, so a file cut off between two lines cannot be told from a smaller mesh.
[[nodiscard]] Result<VolumeMesh> read_inp_file(const std::filesystem::path& path);

/// The same from memory. @param name for messages
[[nodiscard]] Result<VolumeMesh> parse_inp(std::string_view text, std::string_view name);

}  // namespace palpable
