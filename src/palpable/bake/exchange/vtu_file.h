/// @file
/// VTK's unstructured grids (.vtu), which ParaView reads: a body's mesh with fields on it.
///
///   N  nodes     E  tetrahedra or triangles
#pragma once

#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <filesystem>
#include <span>
#include <string>

namespace palpable {

/// A field on the nodes or the elements of a mesh.
struct VtuField {
  std::string name;
  /// (components x N or E). Three components are a vector, six a symmetric tensor in the order
  /// xx yy zz xy yz zx, which is VTK's too.
  Eigen::MatrixXd values;
};

/// Writes 4-node (VTK cell type 10) or 10-node (24) tetrahedra. Values are raw little-endian
/// doubles behind the XML header (appended data): they are exact, and the file is about as large as
/// its numbers.
/// @throws Error if the file cannot be written
/// @throws ContractViolation for a field of another size than the mesh
void write_vtu_file(const std::filesystem::path& path, const TetMesh& mesh,
                    std::span<const VtuField> node_fields,
                    std::span<const VtuField> element_fields = {});

/// The same for a surface of triangles (VTK cell type 5).
void write_vtu_file(const std::filesystem::path& path, const SurfaceMesh& surface,
                    std::span<const VtuField> node_fields);

}  // namespace palpable
