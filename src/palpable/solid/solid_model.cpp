#include "palpable/solid/solid_model.h"

#include "palpable/base/error.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <numeric>
#include <utility>

namespace palpable {
namespace {

// A tetrahedron flatter than this, volume over longest edge cubed, has no usable gradients: a
// regular one has 0.12, mesh generators stay above 1e-4.
constexpr double kFlat = 1e-9;

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
  if (first < 0) return;
  throw Error(fmt::format(
      "the mesh has {} inverted and {} flat tetrahedra of {}; the first is tetrahedron {} (nodes "
      "{} "
      "{} {} {}, volume {:.3g} m^3): swap two of its nodes if all are inverted, else mesh the body "
      "anew",
      inverted, flat, mesh.tet_count(), first, mesh.tets(0, first), mesh.tets(1, first),
      mesh.tets(2, first), mesh.tets(3, first), first_volume));
}

// Root of the set that `node` belongs to, halving paths on the way.
int root_of(std::vector<int>& parent, int node) {
  auto at = [&](int n) -> int& { return parent[static_cast<std::size_t>(n)]; };
  while (at(node) != node) {
    at(node) = at(at(node));
    node = at(node);
  }
  return node;
}

void check_supports(const SolidModel& model) {
  const TetMesh& mesh = model.mesh;
  const int N = mesh.node_count();
  std::vector<char> held(static_cast<std::size_t>(N), 0), used(static_cast<std::size_t>(N), 0);
  for (const int n : model.fixed_nodes) {
    if (n < 0 || n >= N) {
      throw Error(
          fmt::format("fixed node {} does not exist; the body has nodes 0 to {}", n, N - 1));
    }
    if (std::exchange(held[static_cast<std::size_t>(n)], char{1}) != 0) {
      throw Error(fmt::format("node {} is listed twice among the fixed nodes", n));
    }
  }
  if (model.fixed_nodes.empty()) {
    throw Error(
        "the body is held nowhere (the set of fixed nodes is empty), so it would fly away: fix at "
        "least three nodes that are not on one line, usually those of the base");
  }
  const auto fixed_count = static_cast<Eigen::Index>(model.fixed_nodes.size());
  if (model.fixed_displacement.cols() != 0 && model.fixed_displacement.cols() != fixed_count) {
    throw Error(fmt::format("{} nodes are fixed but {} displacements are given for them",
                            fixed_count, model.fixed_displacement.cols()));
  }
  if (!model.fixed_displacement.allFinite()) {
    throw Error("a displacement of a fixed node is not finite");
  }

  // Every separate part needs supports of its own.
  std::vector<int> parent(static_cast<std::size_t>(N));
  std::iota(parent.begin(), parent.end(), 0);
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int k = 0; k < 4; ++k) {
      used[static_cast<std::size_t>(mesh.tets(k, e))] = 1;
      const int a = root_of(parent, mesh.tets(0, e)), b = root_of(parent, mesh.tets(k, e));
      parent[static_cast<std::size_t>(b)] = a;
    }
  }
  std::vector<std::vector<int>> held_in_part(static_cast<std::size_t>(N));
  std::vector<int> size(static_cast<std::size_t>(N), 0);
  for (int n = 0; n < N; ++n) {
    if (used[static_cast<std::size_t>(n)] == 0 && held[static_cast<std::size_t>(n)] == 0) {
      throw Error(fmt::format("node {} belongs to no tetrahedron; remove it from the mesh", n));
    }
    const auto part = static_cast<std::size_t>(root_of(parent, n));
    ++size[part];
    if (held[static_cast<std::size_t>(n)] != 0) held_in_part[part].push_back(n);
  }
  for (int n = 0; n < N; ++n) {
    const auto part = static_cast<std::size_t>(n);
    if (size[part] == 0 || used[part] == 0) continue;
    const std::vector<int>& nodes = held_in_part[part];
    // The largest distance from the first held node, then the largest from the line to there.
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(), along = origin;
    double off_line = 0.0;
    if (!nodes.empty()) origin = mesh.nodes.col(nodes.front());
    for (const int m : nodes) {
      const Eigen::Vector3d d = mesh.nodes.col(m) - origin;
      if (d.squaredNorm() > along.squaredNorm()) along = d;
    }
    for (const int m : nodes) {
      off_line = std::max(off_line, along.normalized().cross(mesh.nodes.col(m) - origin).norm());
    }
    // 1e-6 of their extent: held so nearly on a line, the tangent is singular to double precision.
    if (nodes.size() >= 3 && off_line > 1e-6 * along.norm()) continue;
    const std::string what = nodes.size() < 3
                                 ? fmt::format("only {} of its nodes are fixed", nodes.size())
                                 : fmt::format("its {} fixed nodes lie on one line", nodes.size());
    throw Error(fmt::format(
        "the supports are singular: {} ({} nodes, around node {}) is free to turn or drift, {}; "
        "fix "
        "at least three nodes that are not on one line",
        size[part] == N ? "the body" : "a separate part of the body", size[part], n, what));
  }
}

}  // namespace

void check_model(const SolidModel& model) {
  check_material(model.material);
  check_elements(model.mesh);
  check_supports(model);
}

}  // namespace palpable
