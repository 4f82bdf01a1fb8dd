#include "palpable/bake/solid/stress_recovery.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

// Largest sum of |weights| of a fit. It bounds the factor by which the fit enlarges errors of the
// elements' values; fits above it are rejected.
constexpr double kMostAmplification = 5.0;
constexpr int kMostRings = 3;  // of elements around a node that a patch may have

// Elements around each node.
struct Neighbours {
  std::vector<int> start, element;

  explicit Neighbours(const TetMesh& mesh) {
    start.assign(static_cast<std::size_t>(mesh.node_count()) + 1, 0);
    for_each(mesh, [&](int n, int /*e*/) { ++start[n + 1]; });
    for (std::size_t n = 1; n < start.size(); ++n) start[n] += start[n - 1];
    element.resize(start.back());
    std::vector<int> next(start.begin(), start.end() - 1);
    for_each(mesh, [&](int n, int e) { element[next[n]++] = e; });
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

std::vector<char> skin_nodes(const TetMesh& mesh) {
  std::vector<char> skin(mesh.node_count(), 0);
  for (const int n : boundary_of(mesh).node_of_vertex) skin[n] = 1;
  return skin;
}

// (10 x 4) extrapolation of a linear field from the four integration points to corners and edges.
//
// With L = a at its own corner and b at the others, a + 3 b = 1, a field sum_c f_c L_c has the
// value v_q = (a - b) f_q + b sum_c f_c at point q, and sum_q v_q = sum_c f_c.
Eigen::Matrix<double, 10, 4> nodes_from_points() {
  const Eigen::Vector4d& L = four_point_rule()[0].barycentric;
  const double own = L.maxCoeff(), other = L.minCoeff();
  Eigen::Matrix<double, 10, 4> weights;
  weights.topRows<4>() =
      (Eigen::Matrix4d::Identity() - Eigen::Matrix4d::Constant(other)) / (own - other);
  for (int k = 0; k < 6; ++k) {
    weights.row(4 + k) = 0.5 * (weights.row(kTetEdges[k][0]) + weights.row(kTetEdges[k][1]));
  }
  return weights;
}

// A linear polynomial fitted to the values of some elements.
struct Fit {
  std::vector<int> elements;
  // (4 x elements) maps the values to the coefficients of 1 and of (X - origin). No columns: there
  // is no fit.
  Eigen::Matrix4Xd coefficients;
  Eigen::Vector3d origin;

  // (elements) weights of the values in the polynomial at X.
  [[nodiscard]] Eigen::VectorXd weights_at(const Eigen::Vector3d& X) const {
    Eigen::Vector4d p;
    p << 1.0, X - origin;
    return coefficients.transpose() * p;
  }
};

Fit fit_around(const Eigen::Vector3d& origin, const std::vector<int>& elements,
               const Eigen::Matrix3Xd& centres) {
  Fit fit{elements, {}, origin};
  const auto count = static_cast<Eigen::Index>(fit.elements.size());
  if (count < 6) return fit;  // four unknowns: fewer points would be interpolated, not smoothed
  Eigen::Matrix4Xd p(4, count);
  p.row(0).setOnes();
  p.bottomRows<3>() = centres(Eigen::all, fit.elements).colwise() - origin;
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

// The elements around a node, ring after ring.
class Patches {
 public:
  explicit Patches(const TetMesh& mesh) : mesh_(mesh), around_(mesh), seen_(mesh.tet_count(), -1) {}

  // The elements of the first `rings` rings around `node`, nearest first.
  std::vector<int> of(int node, int rings) {
    std::vector<int> patch;
    add_around(node, node, patch);
    for (int ring = 1; ring < rings; ++ring) {
      const std::size_t before = patch.size();
      for (std::size_t k = 0; k < before; ++k) {
        for (const int corner : mesh_.tets.col(patch[k])) add_around(corner, node, patch);
      }
    }
    for (const int e : patch) seen_[e] = -1;
    return patch;
  }

 private:
  void add_around(int n, int centre, std::vector<int>& patch) {
    for (int k = around_.start[n]; k < around_.start[n + 1]; ++k) {
      const int e = around_.element[k];
      if (seen_[e] == centre) continue;
      seen_[e] = centre;
      patch.push_back(e);
    }
  }

  const TetMesh& mesh_;
  Neighbours around_;
  std::vector<int> seen_;  // (elements) the node whose patch is being built and holds it, else -1
};

// (N) a polynomial around each inner node. Its patch surrounds the node, so that the errors of its
// elements cancel. None for nodes of the skin, or where the points determine no polynomial.
std::vector<Fit> inner_fits(const TetMesh& mesh, const Eigen::Matrix3Xd& centres,
                            Patches& patches) {
  const std::vector<char> skin = skin_nodes(mesh);
  std::vector<Fit> fits(mesh.node_count());
  for (int n = 0; n < mesh.node_count(); ++n) {
    Fit& fit = fits[n];
    if (skin[n] != 0) continue;
    for (int rings = 1; rings <= 2; ++rings) {
      fit = fit_around(mesh.nodes.col(n), patches.of(n, rings), centres);
      if (fit.coefficients.cols() == 0) continue;
      if (fit.coefficients.row(0).lpNorm<1>() <= kMostAmplification) break;
      fit.coefficients.resize(4, 0);
    }
  }
  return fits;
}

// The weights of the elements' values in the value of one node, from one polynomial or several.
class NodeWeights {
 public:
  NodeWeights(const TetMesh& mesh, const Eigen::Matrix3Xd& centres, Patches& patches)
      : mesh_(mesh),
        centres_(centres),
        patches_(patches),
        fits_(inner_fits(mesh, centres, patches)),
        sum_(Eigen::VectorXd::Zero(mesh.tet_count())) {}

  // Finds weights for node n; false: no polynomial serves there.
  bool add(int n) { return add_own(n) || add_mean_of_inner(n) || add_around(n); }

  // Calls visit(point, weight) for each weight, and sets all weights to zero.
  template <class Visit>
  void visit_and_clear(const Visit& visit) {
    for (const int point : touched_) {
      if (sum_[point] != 0.0) visit(point, sum_[point]);
      sum_[point] = 0.0;
    }
    touched_.clear();
  }

 private:
  void add(const Fit& fit, const Eigen::VectorXd& weights, double share) {
    for (std::size_t k = 0; k < fit.elements.size(); ++k) {
      const int point = fit.elements[k];
      if (sum_[point] == 0.0) touched_.push_back(point);
      sum_[point] += share * weights[static_cast<Eigen::Index>(k)];
    }
  }

  bool add_own(int n) {
    const Fit& own = fits_[n];
    if (own.coefficients.cols() == 0) return false;
    add(own, own.weights_at(mesh_.nodes.col(n)), 1.0);
    return true;
  }

  // The mean of the nearest inner nodes' polynomials at this node.
  bool add_mean_of_inner(int n) {
    const Eigen::Vector3d X = mesh_.nodes.col(n);
    for (int rings = 1; rings <= kMostRings; ++rings) {
      std::vector<int> inner;
      for (const int e : patches_.of(n, rings)) {
        for (const int corner : mesh_.tets.col(e)) {
          const Fit& fit = fits_[corner];
          if (fit.coefficients.cols() > 0 && fit.weights_at(X).lpNorm<1>() <= kMostAmplification) {
            inner.push_back(corner);
          }
        }
      }
      std::sort(inner.begin(), inner.end());
      inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
      for (const int m : inner) {
        add(fits_[m], fits_[m].weights_at(X), 1.0 / static_cast<double>(inner.size()));
      }
      if (!inner.empty()) return true;
    }
    return false;
  }

  // A polynomial of the node's own, from elements that may lie to one side of it.
  bool add_around(int n) {
    const Eigen::Vector3d X = mesh_.nodes.col(n);
    for (int rings = 2; rings <= kMostRings; ++rings) {
      const Fit fit = fit_around(X, patches_.of(n, rings), centres_);
      if (fit.coefficients.cols() == 0) continue;
      const Eigen::VectorXd weights = fit.weights_at(X);
      if (!(weights.lpNorm<1>() <= kMostAmplification)) continue;
      add(fit, weights, 1.0);
      return true;
    }
    return false;
  }

  const TetMesh& mesh_;
  const Eigen::Matrix3Xd& centres_;
  Patches& patches_;
  std::vector<Fit> fits_;
  Eigen::VectorXd sum_;  // weights of one node; zero in between
  std::vector<int> touched_;
};

}  // namespace

StressRecovery::StressRecovery(const TetMesh& mesh) {
  if (mesh.is_quadratic()) {
    recover_from_elements(mesh);
  } else {
    recover_from_patches(mesh);
  }
}

void StressRecovery::recover_from_elements(const TetMesh& mesh) {
  points_ = 4 * static_cast<Eigen::Index>(mesh.tet_count());
  const Neighbours around(mesh);
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  const Eigen::Matrix<double, 10, 4> weights = nodes_from_points();
  start_.push_back(0);
  for (int n = 0; n < mesh.node_count(); ++n) {
    const int begin = around.start[n];
    const int end = around.start[n + 1];
    double volume = 0.0;
    for (int k = begin; k < end; ++k) volume += volumes[around.element[k]];
    for (int k = begin; k < end; ++k) {
      const int e = around.element[k];
      const Eigen::Matrix<int, 10, 1> nodes = quadratic_nodes(mesh, e);
      const auto corner = std::find(nodes.begin(), nodes.end(), n) - nodes.begin();
      for (int q = 0; q < 4; ++q)
        terms_.push_back({4 * e + q, weights(corner, q) * volumes[e] / volume});
    }
    start_.push_back(static_cast<int>(terms_.size()));
  }
}

void StressRecovery::recover_from_patches(const TetMesh& mesh) {
  points_ = mesh.tet_count();
  Eigen::Matrix3Xd centres(3, mesh.tet_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    centres.col(e) = mesh.nodes(Eigen::all, mesh.tets.col(e)).rowwise().mean();
  }
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  Patches patches(mesh);
  NodeWeights weights(mesh, centres, patches);
  start_.push_back(0);
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (!weights.add(n)) {
      const std::vector<int> patch = patches.of(n, 1);
      double volume = 0.0;
      for (const int e : patch) volume += volumes[e];
      for (const int e : patch) terms_.push_back({e, volumes[e] / volume});
      averaged_nodes_ += patch.empty() ? 0 : 1;
    }
    weights.visit_and_clear([&](int point, double weight) { terms_.push_back({point, weight}); });
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
    for (int k = start_[n]; k < start_[n + 1]; ++k) {
      const Term& term = terms_[k];
      sum += term.weight * at_points.col(term.point);
    }
    nodal.col(n) = sum;
  }
  return nodal;
}

Eigen::MatrixXd StressRecovery::apply_at(const std::vector<int>& nodes,
                                         const Eigen::MatrixXd& at_points) const {
  PALPABLE_EXPECT(at_points.cols() == points_, "values at the integration points of the mesh");
  Eigen::MatrixXd nodal =
      Eigen::MatrixXd::Zero(at_points.rows(), static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto node = static_cast<std::size_t>(nodes[n]);
    for (int k = start_[node]; k < start_[node + 1]; ++k) {
      const Term& term = terms_[k];
      nodal.col(static_cast<Eigen::Index>(n)) += term.weight * at_points.col(term.point);
    }
  }
  return nodal;
}

}  // namespace palpable
