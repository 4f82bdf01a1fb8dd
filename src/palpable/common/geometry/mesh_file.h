/// @file
/// Reads surfaces from the common file formats: STL, PLY, OBJ, 3DS, OFF.
///
/// The readers are our own and not a library's, because files are untrusted and only vertices and
/// triangles are needed; they are fuzzed (docs/decisions/mesh-readers.md).
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <filesystem>
#include <span>
#include <string_view>

namespace palpable {

/// Reads a surface; the format follows from the extension (.stl .ply .obj .3ds .off, any case).
///
/// Lengths are not converted. Polygons are cut into triangle fans; vertices that coincide exactly
/// are joined and unused ones dropped. Textures, normals, colours and groups are skipped. For any
/// bytes, the result is a surface with at least one triangle and finite vertices (not necessarily
/// watertight, see check_watertight()) or a problem that names the file, the line or byte, and the
/// error.
[[nodiscard]] Result<SurfaceMesh> read_surface_file(const std::filesystem::path& path);

/// The same from memory. @param extension ".stl", ".ply", ...  @param name for messages
[[nodiscard]] Result<SurfaceMesh> parse_surface(std::string_view bytes, std::string_view extension,
                                                std::string_view name);

/// Writes a surface as binary little-endian PLY (vertices as double).
/// @throws Error when the file cannot be written
void write_ply(const std::filesystem::path& path, const SurfaceMesh& surface);

/// A surface with a number at each vertex.
struct ValuedSurface {
  SurfaceMesh surface;
  Eigen::VectorXd values;  ///< (N); empty if the file has none
};

/// Like write_ply(), with a property (float) of each vertex.
/// @param property  name of the property, one word
/// @throws Error when the file cannot be written
void write_valued_ply(const std::filesystem::path& path, const ValuedSurface& surface,
                      std::string_view property);

/// Reads a PLY file without changing its vertices: they keep their order, none are joined or
/// dropped.
/// @return a problem as read_surface_file()'s, also when a value is not finite
[[nodiscard]] Result<ValuedSurface> read_valued_ply(const std::filesystem::path& path,
                                                    std::string_view property);

/// Like write_ply(), with a colour of each vertex, and vertices as float.
/// @param colors   one for each vertex
/// @param comment  one line of the header
/// @throws Error when the file cannot be written
void write_colored_ply(const std::filesystem::path& path, const SurfaceMesh& surface,
                       std::span<const Rgb> colors, std::string_view comment);

}  // namespace palpable
