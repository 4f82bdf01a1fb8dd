#include "palpable/bake/mesh/volume_mesh.h"

#include "palpable/bake/mesh/field_files.h"
#include "palpable/bake/mesh/inp_file.h"
#include "palpable/bake/mesh/mesh_text.h"
#include "palpable/bake/mesh/msh_file.h"
#include "palpable/common/base/contract.h"

#include <fmt/format.h>

#include <algorithm>

namespace palpable {
namespace {

// Reads the tetrahedra (cells 10 or 24) of an unstructured grid of VTK's (.vtu, .vtk); fields are
// ignored, and the format has no sets. Points are numbered from 0. Lines, triangles and points that
// no tetrahedron uses are dropped, other solids refused.
Result<VolumeMesh> read_vtk_volume(const std::filesystem::path& path) {
  NodalFile file;
  try {
    file = read_nodal_file(path);
  } catch (const Error& error) { return Problem{error.what()}; }
  return read_mesh_text({}, path.string(), [&](std::string_view) {
    FileMesh mesh;
    for (Eigen::Index n = 0; n < file.points.cols(); ++n) {
      mesh.nodes[n] = file.points.col(n);
      if (!file.points.col(n).allFinite()) {
        throw MeshDefect{0, fmt::format("point {} is not a number", n)};
      }
    }
    std::int64_t number = 0;
    for (const std::vector<std::int64_t>& tet : file.tets) {
      FileMesh::Tet here{number++, 0, static_cast<int>(tet.size()), {}};
      std::copy(tet.begin(), tet.end(), here.nodes.begin());
      mesh.tets.push_back(here);
    }
    return mesh;
  });
}

}  // namespace

std::vector<int> with_edge_middles(const TetMesh& mesh, const std::vector<int>& nodes) {
  std::vector<char> chosen(mesh.node_count(), 0);
  for (const int n : nodes) chosen[n] = 1;
  std::vector<int> all = nodes;
  for (Eigen::Index e = 0; e < mesh.edge_nodes.cols(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const auto a = static_cast<std::size_t>(mesh.tets(kTetEdges[k][0], e));
      const auto b = static_cast<std::size_t>(mesh.tets(kTetEdges[k][1], e));
      if (chosen[a] != 0 && chosen[b] != 0) all.push_back(mesh.edge_nodes(k, e));
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

VolumeMesh with_edge_nodes(VolumeMesh volume) {
  volume.mesh = with_edge_nodes(volume.mesh);
  for (auto& [name, nodes] : volume.sets.nodes) nodes = with_edge_middles(volume.mesh, nodes);
  return volume;
}

bool is_volume_file(const std::filesystem::path& path) {
  const auto is = [&](const char* ending) { return path.extension() == ending; };
  return is(".msh") || is(".inp") || is(".vtu") || is(".vtk");
}

Result<VolumeMesh> read_volume_file(const std::filesystem::path& path) {
  PALPABLE_EXPECT(is_volume_file(path), "a file of a volume mesh");
  if (path.extension() == ".msh") return read_msh_file(path);
  return path.extension() == ".inp" ? read_inp_file(path) : read_vtk_volume(path);
}

}  // namespace palpable
