#include "palpable/bake/body_problem.h"

#include "palpable/bake/contact_sites.h"
#include "palpable/base/contract.h"
#include "palpable/solid/loads.h"
#include "palpable/solid/patch_load.h"

#include <algorithm>
#include <utility>

namespace palpable {

using Eigen::Matrix3Xd;

std::vector<std::uint8_t> fixed_vertices(const BodyMesh& mesh) {
  std::vector<std::uint8_t> fixed(mesh.boundary.node_of_vertex.size(), 0);
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    fixed[v] = std::binary_search(mesh.fixed_nodes.begin(), mesh.fixed_nodes.end(),
                                  mesh.boundary.node_of_vertex[v]);
  }
  return fixed;
}

BodyProblem pose_body(const BodyDescription& description) {
  BodyProblem problem;
  problem.mesh = make_body_mesh(description);
  const BodyMesh& mesh = problem.mesh;
  problem.sites = choose_sites(mesh.boundary.surface, fixed_vertices(mesh),
                               {.count = description.sites.count,
                                .lowest = description.sites.above * mesh.height,
                                .patch_distance = description.sites.patch});
  problem.press = description.press.depth * mesh.height;
  problem.model.mesh = mesh.mesh;
  problem.model.material = material_from_young(description.material.law, description.material.young,
                                               description.material.poisson);
  problem.model.fixed_nodes = mesh.fixed_nodes;
  return problem;
}

Matrix3Xd unit_load(const Site& site, const Boundary& boundary, int node_count) {
  std::vector<int> nodes;
  std::vector<double> weights;
  for (std::size_t k = 0; k < site.patch.size(); ++k) {
    nodes.push_back(boundary.node_of_vertex[static_cast<std::size_t>(site.patch[k])]);
    weights.push_back(static_cast<double>(site.weights[k]));
  }
  return patch_force(node_count, nodes, weights, site.direction);
}

SolidModel with_edge_nodes(const SolidModel& model) {
  PALPABLE_EXPECT(model.fixed_displacement.cols() == 0 && model.supports.empty(),
                  "a body that is held as descriptions have it");
  SolidModel fine = model;
  fine.mesh = with_edge_nodes(model.mesh);
  std::vector<char> held(static_cast<std::size_t>(fine.mesh.node_count()), 0);
  for (const int n : model.fixed_nodes) held[static_cast<std::size_t>(n)] = 1;
  std::vector<int> more;
  for (int e = 0; e < fine.mesh.tet_count(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const auto a = static_cast<std::size_t>(fine.mesh.tets(kTetEdges[k][0], e));
      const auto b = static_cast<std::size_t>(fine.mesh.tets(kTetEdges[k][1], e));
      if (held[a] != 0 && held[b] != 0) more.push_back(fine.mesh.edge_nodes(k, e));
    }
  }
  std::sort(more.begin(), more.end());
  more.erase(std::unique(more.begin(), more.end()), more.end());
  fine.fixed_nodes.insert(fine.fixed_nodes.end(), more.begin(), more.end());
  return fine;
}

Matrix3Xd unit_traction(const Site& site, const Boundary& boundary, const TetMesh& mesh) {
  const Eigen::VectorXd areas = vertex_areas(boundary.surface);
  Matrix3Xd traction = Matrix3Xd::Zero(3, mesh.node_count());
  double sum = 0.0;
  for (const float w : site.weights) sum += static_cast<double>(w);
  for (std::size_t k = 0; k < site.patch.size(); ++k) {
    const int v = site.patch[k];
    traction.col(boundary.node_of_vertex[static_cast<std::size_t>(v)]) =
        static_cast<double>(site.weights[k]) / (sum * areas[v]) * site.direction.normalized();
  }
  Eigen::Matrix3Xi triangles = boundary.surface.triangles;
  for (int& n : triangles.reshaped()) n = boundary.node_of_vertex[static_cast<std::size_t>(n)];
  return traction_load(mesh, triangles, traction);
}

}  // namespace palpable
