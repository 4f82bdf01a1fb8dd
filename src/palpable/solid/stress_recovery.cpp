#include "palpable/solid/stress_recovery.h"

#include "palpable/base/contract.h"
#include "palpable/solid/quadrature.h"
#include "palpable/solid/shape_gradients.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <span>
#include <vector>

namespace palpable {
namespace {

constexpr double kMostAmplification = 5.0;
constexpr int kMostRings = 3;

// Elements around each node.
struct Neighbours {
  std::vector<int> start, element;

  explicit Neighbours(const TetMesh& mesh) {
    start.assign(static_cast<std::size_t>(mesh.node_count()) + 1, 0);
    for_each(mesh, [&](int n, int /*e*/) { ++start[static_cast<std::size_t>(n) + 1]; });
    for (std::size_t n = 1; n < start.size(); ++n) start[n] += start[n - 1];
    element.resize(static_cast<std::size_t>(start.back()));
    std::vector<int> next(start.begin(), start.end() - 1);
    for_each(mesh, [&](int n, int e) {
      element[static_cast<std::size_t>(next[static_cast<std::size_t>(n)]++)] = e;
    });
  }

  template <class Visit>
  static void for_each(const TetMesh& mesh, const Visit& visit) {
    for (int e = 0; e < mesh.tet_count(); ++e) {
      for (const int n : mesh.tets.col(e)) visit(n, e);
      if (!mesh.is_quadratic()) continue;
      for (const int n : mesh.edge_nodes.col(e)) visit(n, e);
    }
  }
};

// (3 x Q E) places of the integration points.
Eigen::Matrix3Xd point_places(const TetMesh& mesh) {
  const int Q = mesh.is_quadratic() ? 4 : 1;
  Eigen::Matrix3Xd places(3, Q * mesh.tet_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    if (Q == 1) {
      places.col(e) = mesh.nodes(Eigen::all, mesh.tets.col(e)).rowwise().mean();
      continue;
    }
    for (int q = 0; q < Q; ++q) {
      const auto& L = four_point_rule()[static_cast<std::size_t>(q)].barycentric;
      places.col(Q * e + q) =
          mesh.nodes(Eigen::all, quadratic_nodes(mesh, e)) * quadratic_shape(L).N;
    }
  }
  return places;
}

std::vector<char> skin_nodes(const TetMesh& mesh) {
  std::vector<char> skin(static_cast<std::size_t>(mesh.node_count()), 0);
  for (const int n : boundary_of(mesh).node_of_vertex) skin[static_cast<std::size_t>(n)] = 1;
  // The middle of an edge between two corners of the skin nearly always lies there too; one that
  // does not only gets a larger patch.
  for (Eigen::Index e = 0; e < mesh.edge_nodes.cols(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const auto a = static_cast<std::size_t>(mesh.tets(kTetEdges[k][0], e));
      const auto b = static_cast<std::size_t>(mesh.tets(kTetEdges[k][1], e));
      if (skin[a] != 0 && skin[b] != 0) {
        skin[static_cast<std::size_t>(mesh.edge_nodes(k, e))] = 1;
      }
    }
  }
  return skin;
}

}  // namespace

namespace {

// A linear polynomial fitted to the values at the points of some elements.
struct Fit {
  std::vector<int> points;
  // (4 x points) coefficients of 1 and of (X - origin) from the values; none if it cannot be made.
  Eigen::Matrix4Xd coefficients;
  Eigen::Vector3d origin;

  // (points) weights of the values in the polynomial at X.
  [[nodiscard]] Eigen::VectorXd weights_at(const Eigen::Vector3d& X) const {
    Eigen::Vector4d p;
    p << 1.0, X - origin;
    return coefficients.transpose() * p;
  }
};

Fit fit_around(const Eigen::Vector3d& origin, std::span<const int> elements, int Q,
               const Eigen::Matrix3Xd& places) {
  Fit fit{{}, {}, origin};
  for (const int e : elements) {
    for (int q = 0; q < Q; ++q) fit.points.push_back(Q * e + q);
  }
  const auto count = static_cast<Eigen::Index>(fit.points.size());
  if (count < 6) return fit;  // four unknowns: with hardly more points nothing is smoothed
  Eigen::Matrix4Xd p(4, count);
  p.row(0).setOnes();
  p.bottomRows<3>() = places(Eigen::all, fit.points).colwise() - origin;
  const double extent = p.bottomRows<3>().colwise().norm().maxCoeff();
  if (!(extent > 0.0)) return fit;
  p.bottomRows<3>() /= extent;
  const Eigen::LDLT<Eigen::Matrix4d> normal(Eigen::Matrix4d(p * p.transpose()));
  // Points in one plane leave a direction undetermined.
  if (!(normal.vectorD().minCoeff() > 1e-4 * static_cast<double>(count))) return fit;
  fit.coefficients = normal.solve(p);
  fit.coefficients.bottomRows<3>() /= extent;
  return fit;
}

}  // namespace

StressRecovery::StressRecovery(const TetMesh& mesh) {
  const int N = mesh.node_count(), Q = mesh.is_quadratic() ? 4 : 1;
  points_ = static_cast<Eigen::Index>(Q) * mesh.tet_count();
  const Neighbours around(mesh);
  const Eigen::Matrix3Xd places = point_places(mesh);
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  const std::vector<char> skin = skin_nodes(mesh);

  // Elements reached from `node` in so many steps, nearest first.
  std::vector<int> seen(static_cast<std::size_t>(mesh.tet_count()), -1);
  const auto patch_of = [&](int node, int rings) {
    std::vector<int> patch;
    const auto touch = [&](int n) {
      for (int k = around.start[static_cast<std::size_t>(n)];
           k < around.start[static_cast<std::size_t>(n) + 1]; ++k) {
        const int e = around.element[static_cast<std::size_t>(k)];
        if (seen[static_cast<std::size_t>(e)] == node) continue;
        seen[static_cast<std::size_t>(e)] = node;
        patch.push_back(e);
      }
    };
    touch(node);
    for (int ring = 1; ring < rings; ++ring) {
      const std::size_t before = patch.size();
      for (std::size_t k = 0; k < before; ++k) {
        for (const int corner : mesh.tets.col(patch[k])) touch(corner);
      }
    }
    for (const int e : patch) seen[static_cast<std::size_t>(e)] = -1;
    return patch;
  };

  // Inside the body, patches surround their node and the errors of their elements cancel.
  std::vector<Fit> fits(static_cast<std::size_t>(N));
  for (int n = 0; n < N; ++n) {
    Fit& fit = fits[static_cast<std::size_t>(n)];
    if (skin[static_cast<std::size_t>(n)] != 0) continue;
    for (int rings = 1; rings <= 2; ++rings) {
      fit = fit_around(mesh.nodes.col(n), patch_of(n, rings), Q, places);
      if (fit.coefficients.cols() == 0) continue;
      if (fit.coefficients.row(0).lpNorm<1>() <= kMostAmplification) break;
      fit.coefficients.resize(4, 0);
    }
  }

  Eigen::VectorXd sum = Eigen::VectorXd::Zero(points_);  // weights of one node; zero in between
  std::vector<int> touched;
  const auto add = [&](const Fit& fit, const Eigen::VectorXd& weights, double share) {
    for (std::size_t k = 0; k < fit.points.size(); ++k) {
      const int point = fit.points[k];
      if (sum[point] == 0.0) touched.push_back(point);
      sum[point] += share * weights[static_cast<Eigen::Index>(k)];
    }
  };
  start_.push_back(0);
  for (int n = 0; n < N; ++n) {
    const Eigen::Vector3d X = mesh.nodes.col(n);
    bool found = false;
    if (const Fit& own = fits[static_cast<std::size_t>(n)]; own.coefficients.cols() > 0) {
      add(own, own.weights_at(X), 1.0);
      found = true;
    }
    // Others take the mean of what the nearest inner nodes' polynomials say here.
    for (int rings = 1; rings <= kMostRings && !found; ++rings) {
      std::vector<int> inner;
      for (const int e : patch_of(n, rings)) {
        for (const int corner : mesh.tets.col(e)) {
          const Fit& fit = fits[static_cast<std::size_t>(corner)];
          if (fit.coefficients.cols() > 0 && fit.weights_at(X).lpNorm<1>() <= kMostAmplification) {
            inner.push_back(corner);
          }
        }
      }
      std::sort(inner.begin(), inner.end());
      inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
      for (const int m : inner) {
        const Fit& fit = fits[static_cast<std::size_t>(m)];
        add(fit, fit.weights_at(X), 1.0 / static_cast<double>(inner.size()));
        found = true;
      }
    }
    for (int rings = 2; rings <= kMostRings && !found; ++rings) {
      const Fit fit = fit_around(X, patch_of(n, rings), Q, places);
      if (fit.coefficients.cols() == 0) continue;
      const Eigen::VectorXd weights = fit.weights_at(X);
      if (!(weights.lpNorm<1>() <= kMostAmplification)) continue;
      add(fit, weights, 1.0);
      found = true;
    }
    if (!found) {
      const std::vector<int> patch = patch_of(n, 1);
      double volume = 0.0;
      for (const int e : patch) volume += volumes[e];
      for (const int e : patch) {
        for (int q = 0; q < Q; ++q) terms_.push_back({Q * e + q, volumes[e] / volume / Q});
      }
      averaged_nodes_ += patch.empty() ? 0 : 1;
    }
    for (const int point : touched) {
      if (sum[point] != 0.0) terms_.push_back({point, sum[point]});
      sum[point] = 0.0;
    }
    touched.clear();
    start_.push_back(static_cast<int>(terms_.size()));
  }
}

Eigen::Matrix<double, 6, Eigen::Dynamic> StressRecovery::apply(
    const Eigen::Matrix<double, 6, Eigen::Dynamic>& at_points) const {
  PALPABLE_EXPECT(at_points.cols() == points_, "values at the integration points of the mesh");
  const auto N = static_cast<Eigen::Index>(start_.size()) - 1;
  Eigen::Matrix<double, 6, Eigen::Dynamic> nodal(6, N);
  for (Eigen::Index n = 0; n < N; ++n) {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (int k = start_[static_cast<std::size_t>(n)]; k < start_[static_cast<std::size_t>(n) + 1];
         ++k) {
      const Term& term = terms_[static_cast<std::size_t>(k)];
      sum += term.weight * at_points.col(term.point);
    }
    nodal.col(n) = sum;
  }
  return nodal;
}

}  // namespace palpable
