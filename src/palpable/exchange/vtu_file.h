/// @file
/// VTK's unstructured grids (.vtu), which ParaView reads: a body's mesh with fields on it.
///
///   N  nodes     E  tetrahedra or triangles
#pragma once

#include "palpable/geometry/surface_mesh.h"
#include "palpable/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <filesystem>
#include <span>
#include <string>

namespace palpable {

struct VtuField {
  std::string name;
  /// (components x N or E). 3 is a vector; 6 a symmetric tensor xx yy zz xy yz zx, which is VTK's
  /// order, too.
  Eigen::MatrixXd values;
};

/// Writes 4-node (VTK cell type 10) or 10-node (24) tetrahedra; values as raw little-endian doubles
/// behind the XML header (appended data), so nothing is lost and a file has about the size of its
/// numbers.
/// @throws Error if the file cannot be written
/// @throws ContractViolation for a field of another size than the mesh
void write_vtu_file(const std::filesystem::path& path, const TetMesh& mesh,
                    std::span<const VtuField> node_fields,
                    std::span<const VtuField> element_fields = {});

/// The same for a surface of triangles (5).
void write_vtu_file(const std::filesystem::path& path, const SurfaceMesh& surface,
                    std::span<const VtuField> node_fields);

}  // namespace palpable
