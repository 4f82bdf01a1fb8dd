/// @file
/// A first description for a user who has only a shape.
#pragma once

#include <filesystem>
#include <string>

namespace palpable {

/// Whether the name ends like that of a surface (.stl .ply .obj .3ds .off, in any case) or of a
/// tetrahedral mesh (.msh .inp .vtu .vtk, in small letters).
[[nodiscard]] bool is_shape_file(const std::filesystem::path& path);

/// Five lines of TOML that describe a body of this shape, to be saved beside it: the unit of its
/// lengths is the one that gives it the size of a thing on a desk, its material is a soft rubber,
/// it stands on its lowest nodes and has 24 sites.
/// @throws Error as the readers of such files
/// @pre is_shape_file(shape)
[[nodiscard]] std::string first_description(const std::filesystem::path& shape);

}  // namespace palpable
