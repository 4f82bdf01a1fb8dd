#include "palpable/bake/mesh/turned_tets.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace palpable {
namespace {

void turn(TetMesh& mesh, Eigen::Index e) {
  std::swap(mesh.tets(2, e), mesh.tets(3, e));
  if (!mesh.is_quadratic()) return;
  // By kTetEdges, swapping corners 2 and 3 swaps the edges 1-2 and 1-3, and 2-0 and 0-3.
  std::swap(mesh.edge_nodes(1, e), mesh.edge_nodes(4, e));
  std::swap(mesh.edge_nodes(2, e), mesh.edge_nodes(3, e));
}

// Whether the two tetrahedra of each shared face lie on either side of it.
bool lie_beside_each_other(const TetMesh& mesh) {
  constexpr int kFacesOfTet[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  struct SharedFace {
    std::array<int, 3> corners;  // sorted
    bool upwards;                // the tetrahedron winds them as they are sorted
  };
  std::vector<SharedFace> faces;
  faces.reserve(4 * static_cast<std::size_t>(mesh.tet_count()));
  for (const auto& tet : mesh.tets.colwise()) {
    for (const auto& f : kFacesOfTet) {
      std::array<int, 3> corners{tet[f[0]], tet[f[1]], tet[f[2]]};
      const int rises =
          (corners[0] < corners[1]) + (corners[1] < corners[2]) + (corners[2] < corners[0]);
      std::sort(corners.begin(), corners.end());
      faces.push_back({corners, rises == 2});
    }
  }
  std::sort(faces.begin(), faces.end(),
            [](const SharedFace& a, const SharedFace& b) { return a.corners < b.corners; });
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].corners != faces[i - 1].corners) continue;
    if (faces[i].upwards == faces[i - 1].upwards) return false;
    if (i > 1 && faces[i].corners == faces[i - 2].corners) return false;
  }
  return true;
}

}  // namespace

int turn_inverted(TetMesh& mesh) {
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  if (volumes.size() == 0 || volumes.minCoeff() > 0.0 || (volumes.array() == 0.0).any()) return 0;
  TetMesh turned = mesh;
  int count = 0;
  for (Eigen::Index e = 0; e < volumes.size(); ++e) {
    if (volumes[e] > 0.0) continue;
    turn(turned, e);
    ++count;
  }
  if (!lie_beside_each_other(turned)) return 0;
  mesh = std::move(turned);
  return count;
}

}  // namespace palpable
