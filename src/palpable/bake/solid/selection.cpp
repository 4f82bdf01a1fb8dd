#include "palpable/bake/solid/selection.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace palpable {

using Eigen::Vector3d;

namespace {

std::string text(const Vector3d& X) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", X[0], X[1], X[2]);
}

// The body's bounding box as text, for messages about sets that miss it.
std::string extent(const TetMesh& mesh) {
  if (mesh.node_count() == 0) return "the body has no nodes";
  return fmt::format("the body reaches from {} to {} m", text(mesh.nodes.rowwise().minCoeff()),
                     text(mesh.nodes.rowwise().maxCoeff()));
}

}  // namespace

std::vector<int> nodes_in_box(const TetMesh& mesh, const Vector3d& low, const Vector3d& high) {
  std::vector<int> nodes;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto X = mesh.nodes.col(n).array();
    if ((X >= low.array()).all() && (X <= high.array()).all()) nodes.push_back(n);
  }
  if (nodes.empty()) {
    throw Error(fmt::format("no node lies in the box from {} to {} m; {}", text(low), text(high),
                            extent(mesh)));
  }
  return nodes;
}

std::vector<int> nodes_on_plane(const TetMesh& mesh, const Vector3d& point, const Vector3d& normal,
                                double distance) {
  const double length = normal.norm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw Error("the normal of a plane is zero or not finite; give a direction");
  }
  std::vector<int> nodes;
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (std::abs(normal.dot(mesh.nodes.col(n) - point)) <= distance * length) nodes.push_back(n);
  }
  if (nodes.empty()) {
    throw Error(
        fmt::format("no node lies within {:.3g} m of the plane through {} with normal {}; {}",
                    distance, text(point), text(normal), extent(mesh)));
  }
  return nodes;
}

int nearest_node(const TetMesh& mesh, const Vector3d& X) {
  PALPABLE_EXPECT(mesh.node_count() > 0, "a mesh with nodes");
  Eigen::Index nearest = 0;
  (mesh.nodes.colwise() - X).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

Eigen::Matrix3Xi skin_triangles(const TetMesh& mesh) {
  const Boundary boundary = boundary_of(mesh);
  Eigen::Matrix3Xi triangles = boundary.surface.triangles;
  for (int& n : triangles.reshaped()) n = boundary.node_of_vertex[n];
  return triangles;
}

Eigen::Matrix3Xi triangles_between(const Eigen::Matrix3Xi& triangles, std::span<const int> nodes) {
  std::vector<int> sorted(nodes.begin(), nodes.end());
  std::sort(sorted.begin(), sorted.end());
  const auto chosen = [&](int n) { return std::binary_search(sorted.begin(), sorted.end(), n); };
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const auto v = triangles.col(t);
    if (std::all_of(v.begin(), v.end(), chosen)) kept.push_back(t);
  }
  if (kept.empty()) {
    throw Error(fmt::format("no triangle of the skin has all its corners among the {} nodes chosen",
                            nodes.size()));
  }
  return triangles(Eigen::all, kept);
}

}  // namespace palpable
