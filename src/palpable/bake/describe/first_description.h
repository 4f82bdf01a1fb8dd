/// @file
/// A description to begin with, for people who have a shape only.
#pragma once

#include <filesystem>
#include <string>

namespace palpable {

/// Whether a name ends like that of a surface (.stl .ply .obj .3ds .off) or of a mesh of tetrahedra
/// (.msh .inp .vtu .vtk), as their readers take them.
[[nodiscard]] bool is_shape_file(const std::filesystem::path& path);

/// Five lines of TOML that describe a body of this shape, to be saved beside it: its lengths are
/// taken to be in the unit that makes it a thing for a desk, its material is a soft rubber, it
/// stands on its lowest nodes and has 24 sites.
/// @throws Error as the readers of such files
/// @pre is_shape_file(shape)
[[nodiscard]] std::string first_description(const std::filesystem::path& shape);

}  // namespace palpable
