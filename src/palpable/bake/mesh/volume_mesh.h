/// @file
/// A volume mesh as a file gives it: tetrahedra, and sets of nodes, faces and tetrahedra by name.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpable {

/// Named parts of a mesh, by its own numbers. The same name may exist for several kinds; a set is
/// empty where no tetrahedron uses its nodes.
struct MeshSets {
  std::map<std::string, std::vector<int>> nodes;              ///< increasing, each once
  std::map<std::string, std::vector<int>> tets;               ///< likewise
  std::map<std::string, std::vector<Eigen::Vector3i>> faces;  ///< corner nodes, in any order
  /// Sets of the file that cannot be used, with the reason, which is the error when one is used.
  std::map<std::string, std::string> unusable;
};

struct VolumeMesh {
  TetMesh mesh;
  MeshSets sets;
  /// (N) The number of each node in the file; none for nodes that with_edge_nodes() adds.
  std::vector<std::int64_t> numbers = {};
  /// What was repaired while the file was read, one line with its figures; empty: nothing.
  std::string repair = {};
};

/// The same body with 10-node tetrahedra, as with_edge_nodes(TetMesh); a set of nodes gets the
/// middle of each edge between two of its nodes. @pre `volume` has 4-node tetrahedra
[[nodiscard]] VolumeMesh with_edge_nodes(VolumeMesh volume);

/// `nodes` (increasing, each once) and, of a 10-node mesh, the middles of the edges between two of
/// them.
[[nodiscard]] std::vector<int> with_edge_middles(const TetMesh& mesh,
                                                 const std::vector<int>& nodes);

/// Whether the file's name is that of a volume mesh: .msh, .inp, .vtu or .vtk, in small letters.
[[nodiscard]] bool is_volume_file(const std::filesystem::path& path);

/// Reads a volume mesh by the ending of its name: msh_file.h, inp_file.h, or
/// VTK's .vtu and .vtk, of which the tetrahedra are read and fields are ignored.
/// @pre is_volume_file(path)
[[nodiscard]] Result<VolumeMesh> read_volume_file(const std::filesystem::path& path);

}  // namespace palpable
