#include "palpable/bake/solid/solid_model.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

namespace palpable {
namespace {

// A tetrahedron flatter than this, volume over longest edge cubed, has no usable gradients: a
// regular one has 0.12, mesh generators stay above 1e-4.
constexpr double kFlat = 1e-9;

// A 10-node element must be right side out at every point where it is evaluated.
void check_edge_nodes(const TetMesh& mesh) {
  if (!mesh.is_quadratic()) return;
  if (mesh.edge_nodes.cols() != mesh.tet_count()) {
    throw Error(fmt::format("the mesh has {} tetrahedra but edge nodes for {}", mesh.tet_count(),
                            mesh.edge_nodes.cols()));
  }
  for (const auto& [L, weight] : four_point_rule()) {
    const QuadraticShape shape = quadratic_shape(L);
    for (int e = 0; e < mesh.tet_count(); ++e) {
      if (mesh.edge_nodes.col(e).minCoeff() < 0 ||
          mesh.edge_nodes.col(e).maxCoeff() >= mesh.node_count()) {
        throw Error(fmt::format("tetrahedron {} has an edge node outside of 0 to {}", e,
                                mesh.node_count() - 1));
      }
      if (quadratic_gradients(mesh, e, shape).volume > 0.0) continue;
      throw Error(fmt::format(
          "tetrahedron {} is turned inside out by its edge nodes: move them to the middles of its "
          "edges",
          e));
    }
  }
}

void check_groups(const SolidModel& model) {
  std::vector<char> grouped(model.mesh.tet_count(), 0);
  for (const MaterialGroup& group : model.groups) {
    check_material(group.material);
    for (const int e : group.elements) {
      if (e < 0 || e >= model.mesh.tet_count()) {
        throw Error(fmt::format("a group of elements names tetrahedron {}; the body has 0 to {}", e,
                                model.mesh.tet_count() - 1));
      }
      if (std::exchange(grouped[e], char{1}) != 0) {
        throw Error(fmt::format("tetrahedron {} is in the groups of elements twice", e));
      }
    }
  }
}

void check_elements(const TetMesh& mesh) {
  if (mesh.tet_count() == 0) throw Error("the body's mesh has no tetrahedra");
  if (!mesh.nodes.allFinite())
    throw Error("the body's mesh has node positions that are not finite");
  int flat = 0, inverted = 0, first = -1;
  double first_volume = 0.0;
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 4; ++k) {
      if (mesh.tets(k, e) < 0 || mesh.tets(k, e) >= mesh.node_count()) {
        throw Error(fmt::format("tetrahedron {} has node {}, but the mesh has nodes 0 to {}", e,
                                mesh.tets(k, e), mesh.node_count() - 1));
      }
    }
    double longest = 0.0;
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        const Eigen::Vector3d edge =
            mesh.nodes.col(mesh.tets(a, e)) - mesh.nodes.col(mesh.tets(b, e));
        longest = std::max(longest, edge.norm());
      }
    }
    const Eigen::Vector3d x0 = mesh.nodes.col(mesh.tets(0, e));
    const Eigen::Vector3d a = mesh.nodes.col(mesh.tets(1, e)) - x0;
    const Eigen::Vector3d b = mesh.nodes.col(mesh.tets(2, e)) - x0;
    const Eigen::Vector3d c = mesh.nodes.col(mesh.tets(3, e)) - x0;
    const double volume = a.cross(b).dot(c) / 6.0;
    const double shape = volume / (longest * longest * longest);
    if (shape > kFlat) continue;
    (shape < -kFlat ? inverted : flat) += 1;
    if (first < 0) {
      first = e;
      first_volume = volume;
    }
  }
  if (first < 0) return check_edge_nodes(mesh);
  throw Error(fmt::format(
      "the mesh has {} inverted and {} flat tetrahedra of {}; the first is tetrahedron {} (nodes "
      "{} "
      "{} {} {}, volume {:.3g} m^3): swap two of its nodes if all are inverted, else mesh the body "
      "anew",
      inverted, flat, mesh.tet_count(), first, mesh.tets(0, first), mesh.tets(1, first),
      mesh.tets(2, first), mesh.tets(3, first), first_volume));
}

// Every held component, increasing; a component that is held twice is listed twice.
std::vector<HeldComponent> all_held(const SolidModel& model) {
  std::vector<HeldComponent> all;
  for (std::size_t k = 0; k < model.fixed_nodes.size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      const double u = model.fixed_displacement.cols() == 0
                           ? 0.0
                           : model.fixed_displacement(i, static_cast<Eigen::Index>(k));
      all.push_back({3 * static_cast<Eigen::Index>(model.fixed_nodes[k]) + i, u});
    }
  }
  for (const Support& support : model.supports) {
    for (int i = 0; i < 3; ++i) {
      if (!support.held[i]) continue;
      all.push_back({3 * static_cast<Eigen::Index>(support.node) + i, support.displacement[i]});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const HeldComponent& a, const HeldComponent& b) { return a.at < b.at; });
  return all;
}

// Root of the set that `node` belongs to, halving paths on the way.
int root_of(std::vector<int>& parent, int node) {
  auto at = [&](int n) -> int& { return parent[n]; };
  while (at(node) != node) {
    at(node) = at(at(node));
    node = at(node);
  }
  return node;
}

// Refuses supports that name no node, contradict each other or are not finite.
void check_held(const SolidModel& model) {
  const int N = model.mesh.node_count();
  std::vector<char> fixed(N, 0);
  for (const int n : model.fixed_nodes) {
    if (n < 0 || n >= N) {
      throw Error(
          fmt::format("fixed node {} does not exist; the body has nodes 0 to {}", n, N - 1));
    }
    if (std::exchange(fixed[n], char{1}) != 0) {
      throw Error(fmt::format("node {} is listed twice among the fixed nodes", n));
    }
  }
  const auto fixed_count = static_cast<Eigen::Index>(model.fixed_nodes.size());
  if (model.fixed_displacement.cols() != 0 && model.fixed_displacement.cols() != fixed_count) {
    throw Error(fmt::format("{} nodes are fixed but {} displacements are given for them",
                            fixed_count, model.fixed_displacement.cols()));
  }
  if (!model.fixed_displacement.allFinite()) {
    throw Error("a displacement of a fixed node is not finite");
  }
  for (const Support& support : model.supports) {
    if (support.node < 0 || support.node >= N) {
      throw Error(fmt::format("a support holds node {}, but the body has nodes 0 to {}",
                              support.node, N - 1));
    }
    if (!support.held.any()) {
      throw Error(fmt::format("a support of node {} holds it in no direction", support.node));
    }
    for (int i = 0; i < 3; ++i) {
      if (support.held[i] && !std::isfinite(support.displacement[i])) {
        throw Error(
            fmt::format("the displacement of the support of node {} is not finite", support.node));
      }
    }
  }
  std::vector<HeldComponent> all = all_held(model);
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (all[k].at == all[k - 1].at && all[k].displacement != all[k - 1].displacement) {
      throw Error(fmt::format("node {} is held in {} at two displacements, {} m and {} m",
                              all[k].at / 3, "xyz"[all[k].at % 3], all[k - 1].displacement,
                              all[k].displacement));
    }
  }
}

// The rigid motion that a part of the body is still free to make, in words; empty if there is none.
std::string freedom(const TetMesh& mesh, const std::vector<HeldComponent>& held) {
  std::vector<Eigen::Index> nodes;
  for (const HeldComponent& h : held) {
    if (nodes.empty() || nodes.back() != h.at / 3) nodes.push_back(h.at / 3);
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Index n : nodes)
    middle += mesh.nodes.col(n) / static_cast<double>(nodes.size());
  double extent = 0.0;
  for (const Eigen::Index n : nodes) extent = std::max(extent, (mesh.nodes.col(n) - middle).norm());
  // One row for each held component: its displacement under each of six rigid motions (drift, turn
  // about the middle). The motions are held if the rows have rank six. Turns are scaled by the
  // part's extent, so that the six columns have comparable size.
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  for (const HeldComponent& h : held) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(h.at % 3);
    Eigen::Matrix<double, 6, 1> row;
    row << axis, (mesh.nodes.col(h.at / 3) - middle).cross(axis) / (extent > 0.0 ? extent : 1.0);
    gram += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> modes(gram);
  // The square of 1e-6 of the extent: when the held nodes lie on a line to that precision, the
  // tangent is singular to double precision.
  const auto loose = (modes.eigenvalues().array() <= 1e-12 * modes.eigenvalues()[5]).count();
  if (loose == 0 && !held.empty()) return {};
  if (held.size() != 3 * nodes.size()) {
    return fmt::format("its {} held directions leave {} of its 6 rigid motions free", held.size(),
                       loose);
  }
  return nodes.size() < 3 ? fmt::format("only {} of its nodes are fixed", nodes.size())
                          : fmt::format("its {} fixed nodes lie on one line", nodes.size());
}

void check_supports(const SolidModel& model) {
  const TetMesh& mesh = model.mesh;
  const int N = mesh.node_count();
  const std::vector<HeldComponent> held = held_components(model);
  if (held.empty()) {
    throw Error(
        "the body is held nowhere (the set of fixed nodes is empty), so it would fly away: fix at "
        "least three nodes that are not on one line, usually those of the base");
  }

  // Every separate part needs supports of its own.
  std::vector<char> used(N, 0), is_held = used;
  std::vector<int> parent(N);
  std::iota(parent.begin(), parent.end(), 0);
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const auto join = [&](int n) {
      used[n] = 1;
      const int a = root_of(parent, mesh.tets(0, e)), b = root_of(parent, n);
      parent[b] = a;
    };
    for (const int n : mesh.tets.col(e)) join(n);
    if (mesh.is_quadratic()) {
      for (const int n : mesh.edge_nodes.col(e)) join(n);
    }
  }
  std::vector<std::vector<HeldComponent>> held_in_part(N);
  for (const HeldComponent& h : held) {
    const auto n = static_cast<std::size_t>(h.at / 3);
    is_held[n] = 1;
    held_in_part[root_of(parent, static_cast<int>(n))].push_back(h);
  }
  std::vector<int> size(N, 0);
  for (int n = 0; n < N; ++n) {
    if (used[n] == 0 && is_held[n] == 0) {
      throw Error(fmt::format("node {} belongs to no tetrahedron; remove it from the mesh", n));
    }
    ++size[root_of(parent, n)];
  }
  for (int n = 0; n < N; ++n) {
    const auto part = static_cast<std::size_t>(n);
    if (size[part] == 0 || used[part] == 0) continue;
    const std::string what = freedom(mesh, held_in_part[part]);
    if (what.empty()) continue;
    throw Error(fmt::format(
        "the supports are singular: {} ({} nodes, around node {}) is free to turn or drift, {}; "
        "fix at least three nodes that are not on one line",
        size[part] == N ? "the body" : "a separate part of the body", size[part], n, what));
  }
}

}  // namespace

std::vector<int> material_groups(const SolidModel& model) {
  std::vector<int> group_of(model.mesh.tet_count(), -1);
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    for (const int e : model.groups[g].elements) { group_of[e] = static_cast<int>(g); }
  }
  return group_of;
}

std::vector<HeldComponent> held_components(const SolidModel& model) {
  std::vector<HeldComponent> held = all_held(model);
  const auto same = [](const HeldComponent& a, const HeldComponent& b) { return a.at == b.at; };
  held.erase(std::unique(held.begin(), held.end(), same), held.end());
  return held;
}

void check_model(const SolidModel& model) {
  check_material(model.material);
  check_elements(model.mesh);
  check_groups(model);
  check_held(model);
  check_supports(model);
}

}  // namespace palpable
