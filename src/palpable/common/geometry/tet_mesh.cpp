#include "palpable/common/geometry/tet_mesh.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <utility>

namespace palpable {

using Eigen::Vector3d;

Eigen::VectorXd tet_volumes(const TetMesh& mesh) {
  Eigen::VectorXd volumes(mesh.tet_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const Vector3d x0 = mesh.nodes.col(mesh.tets(0, e));
    const Vector3d a = mesh.nodes.col(mesh.tets(1, e)) - x0;
    const Vector3d b = mesh.nodes.col(mesh.tets(2, e)) - x0;
    const Vector3d c = mesh.nodes.col(mesh.tets(3, e)) - x0;
    volumes[e] = a.cross(b).dot(c) / 6.0;
  }
  return volumes;
}

Eigen::VectorXd nodal_volumes(const TetMesh& mesh) {
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  Eigen::VectorXd nodal = Eigen::VectorXd::Zero(mesh.node_count());
  const double corner = mesh.is_quadratic() ? 1.0 / 36.0 : 1.0 / 4.0;
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 4; ++k) nodal[mesh.tets(k, e)] += corner * volumes[e];
    if (!mesh.is_quadratic()) continue;
    for (const int n : mesh.edge_nodes.col(e)) nodal[n] += 4.0 / 27.0 * volumes[e];
  }
  return nodal;
}

TetMesh with_edge_nodes(const TetMesh& mesh) {
  PALPABLE_EXPECT(!mesh.is_quadratic(), "a mesh of 4-node tetrahedra");
  // (lower corner, higher corner, element, edge), so that sorting makes equal edges adjacent.
  std::vector<std::array<int, 4>> edges;
  edges.reserve(6 * static_cast<std::size_t>(mesh.tet_count()));
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const auto [low, high] =
          std::minmax({mesh.tets(kTetEdges[k][0], e), mesh.tets(kTetEdges[k][1], e)});
      edges.push_back({low, high, e, k});
    }
  }
  std::sort(edges.begin(), edges.end());
  TetMesh fine;
  fine.tets = mesh.tets;
  fine.edge_nodes.resize(6, mesh.tet_count());
  std::vector<std::array<int, 2>> ends;
  for (const auto& [low, high, e, k] : edges) {
    if (ends.empty() || ends.back() != std::array{low, high}) ends.push_back({low, high});
    fine.edge_nodes(k, e) = mesh.node_count() + static_cast<int>(ends.size()) - 1;
  }
  fine.nodes.resize(3, mesh.node_count() + static_cast<Eigen::Index>(ends.size()));
  fine.nodes.leftCols(mesh.node_count()) = mesh.nodes;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    fine.nodes.col(mesh.node_count() + static_cast<Eigen::Index>(k)) =
        0.5 * (mesh.nodes.col(ends[k][0]) + mesh.nodes.col(ends[k][1]));
  }
  return fine;
}

TetMesh split_into_eight(const TetMesh& mesh) {
  PALPABLE_EXPECT(mesh.is_quadratic(), "a mesh of 10-node tetrahedra");
  // Nodes of an element: corners 0..3, then edges 4..9 as in kTetEdges.
  constexpr int kCorners[4][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}};
  // A diagonal joins the middles of opposite edges; the other four go around it, so that
  // (diagonal, one, next) is positive.
  struct Cut {
    int from, to, around[4];
  };
  constexpr Cut kCuts[3] = {{4, 9, {5, 6, 7, 8}}, {5, 7, {4, 8, 9, 6}}, {6, 8, {4, 5, 9, 7}}};
  TetMesh fine;
  fine.nodes = mesh.nodes;
  fine.tets.resize(4, 8 * static_cast<Eigen::Index>(mesh.tet_count()));
  for (int e = 0; e < mesh.tet_count(); ++e) {
    Eigen::Matrix<int, 10, 1> node;
    node << mesh.tets.col(e), mesh.edge_nodes.col(e);
    Eigen::Index child = 8 * static_cast<Eigen::Index>(e);
    for (const auto& c : kCorners) {
      fine.tets.col(child++) << node[c[0]], node[c[1]], node[c[2]], node[c[3]];
    }
    const auto length = [&](const Cut& cut) {
      return (mesh.nodes.col(node[cut.from]) - mesh.nodes.col(node[cut.to])).squaredNorm();
    };
    const Cut& cut =
        *std::min_element(std::begin(kCuts), std::end(kCuts),
                          [&](const Cut& a, const Cut& b) { return length(a) < length(b); });
    for (int k = 0; k < 4; ++k) {
      fine.tets.col(child++) << node[cut.from], node[cut.to], node[cut.around[k]],
          node[cut.around[(k + 1) % 4]];
    }
  }
  return fine;
}

std::vector<int> node_components(const TetMesh& mesh) {
  std::vector<int> parents(mesh.node_count());
  std::iota(parents.begin(), parents.end(), 0);
  std::vector<char> used(mesh.node_count(), 0);
  const auto set_of = [&](int node) {
    while (parents[node] != node) node = parents[node] = parents[parents[node]];
    return node;
  };
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const auto join = [&](int node) {
      used[node] = 1;
      parents[set_of(node)] = set_of(mesh.tets(0, e));
    };
    for (const int node : mesh.tets.col(e)) join(node);
    if (!mesh.is_quadratic()) continue;
    for (const int node : mesh.edge_nodes.col(e)) join(node);
  }
  std::vector<int> component_of_set(mesh.node_count(), -1), components(mesh.node_count(), -1);
  int count = 0;
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (used[node] == 0) continue;
    int& component = component_of_set[set_of(node)];
    if (component < 0) component = count++;
    components[node] = component;
  }
  return components;
}

Boundary boundary_of(const TetMesh& mesh) {
  struct Face {
    std::array<int, 3> key;  // sorted nodes
    Eigen::Vector3i nodes;   // outward orientation
  };
  // Face opposite to node k, counter-clockwise from outside for a positive tetrahedron.
  constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(mesh.tet_count()) * 4);
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (const auto& f : kFaces) {
      const Eigen::Vector3i nodes(mesh.tets(f[0], e), mesh.tets(f[1], e), mesh.tets(f[2], e));
      std::array<int, 3> key{nodes[0], nodes[1], nodes[2]};
      std::sort(key.begin(), key.end());
      faces.push_back({key, nodes});
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.key < b.key; });

  std::vector<Eigen::Vector3i> skin;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t j = i + 1;
    while (j < faces.size() && faces[j].key == faces[i].key) ++j;
    if (j - i == 1) skin.push_back(faces[i].nodes);
    i = j;
  }

  Boundary boundary;
  std::vector<int> vertex_of_node(mesh.node_count(), -1);
  for (const Eigen::Vector3i& f : skin) {
    for (int k = 0; k < 3; ++k) vertex_of_node[f[k]] = 0;
  }
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (vertex_of_node[n] < 0) continue;
    vertex_of_node[n] = static_cast<int>(boundary.node_of_vertex.size());
    boundary.node_of_vertex.push_back(n);
  }
  boundary.surface.vertices = mesh.nodes(Eigen::all, boundary.node_of_vertex);
  boundary.surface.triangles.resize(3, static_cast<Eigen::Index>(skin.size()));
  for (std::size_t t = 0; t < skin.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      boundary.surface.triangles(k, static_cast<Eigen::Index>(t)) = vertex_of_node[skin[t][k]];
    }
  }
  return boundary;
}

TetMesh box_tets(const Vector3d& a, const Vector3d& b, int nx, int ny, int nz) {
  PALPABLE_EXPECT(nx >= 1 && ny >= 1 && nz >= 1, "a box has at least one cell each way");
  PALPABLE_EXPECT((b - a).minCoeff() > 0.0, "corner a lies below corner b");
  TetMesh mesh;
  mesh.nodes.resize(3, static_cast<Eigen::Index>(nx + 1) * (ny + 1) * (nz + 1));
  const auto node = [&](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  for (int k = 0; k <= nz; ++k) {
    for (int j = 0; j <= ny; ++j) {
      for (int i = 0; i <= nx; ++i) {
        const Vector3d t(double(i) / nx, double(j) / ny, double(k) / nz);
        mesh.nodes.col(node(i, j, k)) = a + t.cwiseProduct(b - a);
      }
    }
  }
  // Kuhn: one tetrahedron per order of walking from corner 000 to corner 111.
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  mesh.tets.resize(4, static_cast<Eigen::Index>(nx) * ny * nz * 6);
  Eigen::Index e = 0;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        for (int o = 0; o < 6; ++o) {
          std::array<int, 3> at{i, j, k};
          Eigen::Vector4i tet;
          tet[0] = node(at[0], at[1], at[2]);
          for (int step = 0; step < 3; ++step) {
            ++at[kOrders[o][step]];
            tet[step + 1] = node(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(tet[2], tet[3]);  // odd orders walk a left-handed tetrahedron
          mesh.tets.col(e++) = tet;
        }
      }
    }
  }
  return mesh;
}

}  // namespace palpable
