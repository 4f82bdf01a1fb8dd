#include "palpable/bake/solid/loads.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace palpable {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

namespace {

// The node on the edge between two corners.
class EdgeNodes {
 public:
  explicit EdgeNodes(const TetMesh& mesh) {
    for (Eigen::Index e = 0; e < mesh.edge_nodes.cols(); ++e) {
      for (int k = 0; k < 6; ++k) {
        const auto [low, high] =
            std::minmax({mesh.tets(kTetEdges[k][0], e), mesh.tets(kTetEdges[k][1], e)});
        all_.push_back({low, high, mesh.edge_nodes(k, e)});
      }
    }
    std::sort(all_.begin(), all_.end());
  }

  [[nodiscard]] int between(int a, int b) const {
    const std::array key{std::min(a, b), std::max(a, b), -1};
    const auto found = std::lower_bound(all_.begin(), all_.end(), key);
    PALPABLE_EXPECT(found != all_.end() && (*found)[0] == key[0] && (*found)[1] == key[1],
                    "triangles of the mesh's skin");
    return (*found)[2];
  }

 private:
  std::vector<std::array<int, 3>> all_;
};

// A point of the skin at which a traction is evaluated.
struct SurfacePoint {
  Eigen::Index triangle;
  Eigen::Vector4d barycentric;
  Vector3d X, n;
};
template <class Traction>
Matrix3Xd integrate(const TetMesh& mesh, const Eigen::Matrix3Xi& triangles,
                    const Traction& traction) {
  Matrix3Xd force = Matrix3Xd::Zero(3, mesh.node_count());
  const EdgeNodes edges(mesh);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i v = triangles.col(t);
    PALPABLE_EXPECT(v.minCoeff() >= 0 && v.maxCoeff() < mesh.node_count(), "nodes of the mesh");
    for (const auto& [L, weight] : triangle_rule()) {
      std::array<std::pair<int, double>, 6> shares;
      Vector3d X = Vector3d::Zero(), along_1 = X, along_2 = X;
      std::size_t count = 0;
      const auto add = [&](int node, double N, double slope_1, double slope_2) {
        shares[count++] = {node, N};
        X += N * mesh.nodes.col(node);
        along_1 += slope_1 * mesh.nodes.col(node);
        along_2 += slope_2 * mesh.nodes.col(node);
      };
      if (mesh.is_quadratic()) {
        const QuadraticShape shape = quadratic_shape(L);
        const int nodes[6] = {v[0],
                              v[1],
                              v[2],
                              edges.between(v[0], v[1]),
                              edges.between(v[1], v[2]),
                              edges.between(v[2], v[0])};
        for (int k = 0; k < 6; ++k) {
          const int a = k < 3 ? k : k + 1;  // nodes 0 1 2 and 4 5 6 of the tetrahedron
          add(nodes[k], shape.N[a], shape.slope(0, a), shape.slope(1, a));
        }
      } else {
        add(v[0], L[0], -1.0, -1.0);
        add(v[1], L[1], 1.0, 0.0);
        add(v[2], L[2], 0.0, 1.0);
      }
      const Vector3d area = 0.5 * along_1.cross(along_2);
      const Vector3d share =
          weight * area.norm() * traction(SurfacePoint{t, L, X, area.normalized()});
      for (std::size_t k = 0; k < count; ++k)
        force.col(shares[k].first) += shares[k].second * share;
    }
  }
  return force;
}

}  // namespace

Matrix3Xd body_force_load(const TetMesh& mesh, const BodyForceField& field) {
  Matrix3Xd force = Matrix3Xd::Zero(3, mesh.node_count());
  for (const auto& [L, weight] : tetrahedron_rule()) {
    const QuadraticShape shape = quadratic_shape(L);
    for (int e = 0; e < mesh.tet_count(); ++e) {
      if (mesh.is_quadratic()) {
        const Eigen::Matrix<int, 10, 1> nodes = quadratic_nodes(mesh, e);
        const Vector3d X = mesh.nodes(Eigen::all, nodes) * shape.N;
        const double volume = quadratic_gradients(mesh, e, shape).volume;
        force(Eigen::all, nodes) += weight * volume * field(X) * shape.N.transpose();
      } else {
        const Eigen::Vector4i nodes = mesh.tets.col(e);
        const Vector3d X = mesh.nodes(Eigen::all, nodes) * L;
        force(Eigen::all, nodes) +=
            weight * shape_gradients(mesh, e).volume * field(X) * L.transpose();
      }
    }
  }
  return force;
}

Matrix3Xd gravity_load(const TetMesh& mesh, double density, const Vector3d& gravity) {
  if (!(density > 0.0) || !std::isfinite(density)) {
    throw Error(
        fmt::format("the density is {} kg/m^3; it must be above 0 (rubber: 1000)", density));
  }
  if (!gravity.allFinite()) throw Error("the acceleration of gravity is not finite");
  const Vector3d force = density * gravity;
  return body_force_load(mesh, [&](const Vector3d&) { return force; });
}

Matrix3Xd traction_load(const TetMesh& mesh, const Eigen::Matrix3Xi& triangles,
                        const TractionField& traction) {
  return integrate(mesh, triangles, [&](const SurfacePoint& p) { return traction(p.X, p.n); });
}

Matrix3Xd pressure_load(const TetMesh& mesh, const Eigen::Matrix3Xi& triangles, double pressure) {
  if (!std::isfinite(pressure)) throw Error("the pressure is not finite");
  return integrate(mesh, triangles,
                   [&](const SurfacePoint& p) -> Vector3d { return -pressure * p.n; });
}

Matrix3Xd traction_load(const TetMesh& mesh, const Eigen::Matrix3Xi& triangles,
                        const Matrix3Xd& traction) {
  PALPABLE_EXPECT(triangles.size() == 0 || triangles.maxCoeff() < traction.cols(),
                  "a traction at each corner");
  return integrate(mesh, triangles, [&](const SurfacePoint& p) -> Vector3d {
    return traction(Eigen::all, triangles.col(p.triangle)) * p.barycentric.head<3>();
  });
}

Eigen::Matrix3Xd patch_force(int node_count, std::span<const int> nodes,
                             std::span<const double> weights, const Eigen::Vector3d& direction) {
  PALPABLE_EXPECT(nodes.size() == weights.size(), "one weight for each node of the patch");
  if (nodes.empty()) throw Error("the load's patch is empty; give it at least one node");
  const double length = direction.norm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw Error("the load's direction is zero or not finite; give a direction");
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k] < 0 || nodes[k] >= node_count) {
      throw Error(fmt::format("the load's patch has node {}, but the body has nodes 0 to {}",
                              nodes[k], node_count - 1));
    }
    if (!(weights[k] >= 0.0) || !std::isfinite(weights[k])) {
      throw Error(fmt::format("the load's weight at node {} is {}; weights are at least 0",
                              nodes[k], weights[k]));
    }
    sum += weights[k];
  }
  if (!(sum > 0.0)) {
    throw Error("the load's weights are all zero; use the nodes' areas, or 1 for each");
  }
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, node_count);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    force.col(nodes[k]) += weights[k] / (sum * length) * direction;
  }
  return force;
}

}  // namespace palpable
