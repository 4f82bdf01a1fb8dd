#include "palpable/bake/mesh/vtk_volume.h"

#include "palpable/bake/mesh/field_files.h"
#include "palpable/bake/mesh/mesh_text.h"

#include <fmt/format.h>

#include <algorithm>

namespace palpable {

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

}  // namespace palpable
