#include "palpable/bake/pipeline/mesh_output.h"

#include "palpable/bake/mesh/volume_mesh.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

// Positions of the nodes of all elements, which do not depend on the nodes' numbers: readers number
// nodes in the order in which elements use them.
template <class Elements>
Eigen::Matrix3Xd positions(const TetMesh& mesh, const Elements& elements) {
  return mesh.nodes(Eigen::all, elements.reshaped());
}

TEST_CASE("a mesh is written in the format of its name and read again to the bit",
          "[pipeline][mesh]") {
  const test::ScratchFolder folder("mesh_output");
  // Unequal sides, so that swapped coordinates or nodes show.
  TetMesh block = box_tets({0, 0, 0}, {0.06, 0.05, 0.04 / 3}, 3, 2, 1);
  const int faces = boundary_of(block).surface.triangle_count();
  for (const TetMesh& mesh : {block, with_edge_nodes(block)}) {
    for (const std::string_view ending : kMeshEndings) {
      INFO(ending << (mesh.is_quadratic() ? ", 10 nodes" : ", 4 nodes"));
      const std::filesystem::path file = folder / ("block" + std::string(ending));
      write_volume_file(file, mesh);
      const VolumeMesh read = value_or_throw(read_volume_file(file));
      CHECK(read.mesh.node_count() == mesh.node_count());
      REQUIRE(read.mesh.tet_count() == mesh.tet_count());
      CHECK(positions(read.mesh, read.mesh.tets) == positions(mesh, mesh.tets));
      REQUIRE(read.mesh.is_quadratic() == mesh.is_quadratic());
      CHECK(positions(read.mesh, read.mesh.edge_nodes) == positions(mesh, mesh.edge_nodes));
      if (ending == ".vtu") continue;  // has no sets
      CHECK(read.sets.tets.size() == 1);
      REQUIRE(read.sets.faces.size() == 1);
      CHECK(static_cast<int>(read.sets.faces.begin()->second.size()) == faces);
      CHECK(read.sets.unusable.empty());
    }
  }
}

}  // namespace
}  // namespace palpable
