#include "palpable/bake/solid/vibration_modes.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

namespace {

// Vectors of one step. A factor solves 16 systems in the time of four alone; a wider block finds
// modes of one frequency together, but needs a larger basis.
constexpr Index kBlockWidth = 8;
// A column of a block that is this much shorter after it was made orthogonal to the basis lies in
// it, but for rounding.
constexpr double kDependent = 1e-10;
// The iteration ends where |K^-1 M x - theta x| <= kConverged theta in the norm of M. One more
// product with K^-1 M follows, after which residuals of K x - omega^2 M x are of the same size.
constexpr double kConverged = 1e-8;
// Modes whose omega differ by less belong together.
constexpr double kPair = 1e-3;
// A basis that is larger than this multiple of the modes has not converged and never will.
constexpr Index kLargestBasis = 20;

struct WeightedPoint {
  Eigen::Vector4d barycentric;
  double weight;
};

// Gauss' rule of four points in [0, 1], exact for polynomials of degree 7.
std::array<std::array<double, 2>, 4> gauss_four() {
  const double inner = std::sqrt(3.0 / 7.0 - 2.0 / 7.0 * std::sqrt(1.2)),
               outer = std::sqrt(3.0 / 7.0 + 2.0 / 7.0 * std::sqrt(1.2));
  const double heavy = (18.0 + std::sqrt(30.0)) / 72.0, light = (18.0 - std::sqrt(30.0)) / 72.0;
  return {{{0.5 - 0.5 * outer, light},
           {0.5 - 0.5 * inner, heavy},
           {0.5 + 0.5 * inner, heavy},
           {0.5 + 0.5 * outer, light}}};
}

// 64 points of a tetrahedron, exact for polynomials of degree 5, where products of two shape
// functions of a 10-node tetrahedron have degree 4: Gauss' rule in collapsed coordinates, as
// tetrahedron_rule(), which has a point less in each of them and is exact to degree 3 only.
std::vector<WeightedPoint> mass_rule() {
  std::vector<WeightedPoint> points;
  for (const auto& [a, wa] : gauss_four()) {
    for (const auto& [b, wb] : gauss_four()) {
      for (const auto& [c, wc] : gauss_four()) {
        points.push_back({{1.0 - a, a * (1.0 - b), a * b * (1.0 - c), a * b * c},
                          6.0 * wa * wb * wc * a * a * b});
      }
    }
  }
  return points;
}

// M applied to each column of nodal vectors (3N x k).
MatrixXd mass_times(const SparseMatrix& M, const MatrixXd& X) {
  MatrixXd Y(X.rows(), X.cols());
  for (Index c = 0; c < X.cols(); ++c) {
    const Eigen::Map<const Eigen::Matrix3Xd> x(X.col(c).data(), 3, M.rows());
    Eigen::Map<Eigen::Matrix3Xd>(Y.col(c).data(), 3, M.rows()) = x * M;
  }
  return Y;
}

// (3N x k) numbers from -1 to 1, the same on every machine.
MatrixXd start(Index rows, Index columns) {
  std::mt19937_64 random(67);
  MatrixXd X(rows, columns);
  for (double& x : X.reshaped()) x = std::ldexp(static_cast<double>(random() >> 11U), -52) - 1.0;
  return X;
}

// Block Lanczos: a basis V (3N x n) with V^T M V = 1, and H = V^T M A V, for A = K^-1 M, which is
// symmetric in the inner product of M.
class Lanczos {
 public:
  Lanczos(const LoadResponse& body, const SparseMatrix& M)
      : body_(body), M_(M), V_(body.free_mask().size(), 0) {
    const MatrixXd X = start(V_.rows(), kBlockWidth);
    next_ = orthonormal(body_.linear(mass_times(M_, body_.free_mask().asDiagonal() * X)));
  }

  [[nodiscard]] Index size() const { return n_; }
  // Nothing is left outside the basis: it spans all displacements that the start can reach.
  [[nodiscard]] bool is_exhausted() const { return next_.cols() == 0; }

  // Adds a block to the basis. @pre !is_exhausted()
  void step() {
    const Index b = next_.cols();
    if (V_.cols() < n_ + b) V_.conservativeResize(Eigen::NoChange, 2 * n_ + 8 * kBlockWidth);
    V_.middleCols(n_, b) = next_;
    n_ += b;
    MatrixXd W = body_.linear(mass_times(M_, next_));
    const MatrixXd h = basis().transpose() * mass_times(M_, W);  // (n x b)
    H_.conservativeResize(n_, n_);
    H_.rightCols(b) = h;
    H_.bottomRows(b) = h.transpose();
    H_.bottomRightCorner(b, b) = 0.5 * (h.bottomRows(b) + MatrixXd(h.bottomRows(b).transpose()));
    W -= basis() * h;
    // R of W = next R, whose last columns bound the residuals of Ritz vectors.
    const MatrixXd rest = W;
    next_ = orthonormal(W);
    R_ = next_.transpose() * mass_times(M_, rest);  // (b' x b)
  }

  // theta of A, decreasing, and how far each is from converged: |A x - theta x| / theta.
  struct Ritz {
    VectorXd theta, distance;
    MatrixXd y;  // x = V y
  };
  [[nodiscard]] Ritz ritz() const {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(H_);
    Ritz found{solver.eigenvalues().reverse(), {}, solver.eigenvectors().rowwise().reverse()};
    found.distance = VectorXd::Zero(n_);
    if (R_.rows() > 0) {
      found.distance = ((R_ * found.y.bottomRows(R_.cols())).colwise().norm().transpose().array() /
                        found.theta.array().max(1e-300))
                           .matrix();
    }
    return found;
  }

  [[nodiscard]] MatrixXd::ConstColsBlockXpr basis() const { return V_.leftCols(n_); }

 private:
  // (3N x b') orthonormal columns, normal to the basis, that span those of W; fewer columns where
  // some of them depend on others. Twice is enough (Giraud, Langou, Rozloznik 2005).
  [[nodiscard]] MatrixXd orthonormal(MatrixXd W) const {
    const VectorXd before =
        (W.array() * mass_times(M_, W).array()).colwise().sum().max(0.0).sqrt().transpose();
    for (int pass = 0; pass < 2 && n_ > 0; ++pass) {
      const MatrixXd h = basis().transpose() * mass_times(M_, W);
      W -= basis() * h;
    }
    Index kept = 0;
    for (Index c = 0; c < W.cols(); ++c) {
      VectorXd w = W.col(c);
      for (int pass = 0; pass < 2 && kept > 0; ++pass) {
        const VectorXd h = W.leftCols(kept).transpose() * mass_times(M_, w);
        w -= W.leftCols(kept) * h;
      }
      const double length = std::sqrt(std::max(0.0, w.dot(mass_times(M_, w).col(0))));
      if (!(length > kDependent * before[c])) continue;
      W.col(kept++) = w / length;
    }
    W.conservativeResize(Eigen::NoChange, kept);
    return W;
  }

  const LoadResponse& body_;
  const SparseMatrix& M_;
  MatrixXd V_;
  Index n_ = 0;
  MatrixXd H_, next_, R_;
};

double omega_of(double theta) { return 1.0 / std::sqrt(theta); }

// How many modes are wanted of those with these theta: the least, all below the bound, and the
// partner of the last.
Index wanted_of(const VectorXd& theta, const VibrationSettings& settings) {
  Index count = 0;
  while (count < theta.size() && theta[count] > 0 &&
         (count < settings.least || omega_of(theta[count]) < settings.below)) {
    ++count;
  }
  count = std::min<Index>(count, settings.most);
  while (count > 0 && count < theta.size() && theta[count] > 0 &&
         omega_of(theta[count]) < (1 + kPair) * omega_of(theta[count - 1])) {
    ++count;
  }
  return count;
}

// The basis is large enough when all wanted modes and the one behind them have converged.
// @returns the number of modes; 0: not yet
Index converged(const Lanczos& lanczos, const Lanczos::Ritz& ritz,
                const VibrationSettings& settings) {
  const Index wanted = wanted_of(ritz.theta, settings);
  if (lanczos.is_exhausted()) return wanted;
  if (wanted + 1 > ritz.theta.size() / 2) return 0;  // the upper half of a basis is never good
  const bool all = (ritz.distance.head(wanted + 1).array() <= kConverged).all();
  return all ? wanted : 0;
}

}  // namespace

SparseMatrix consistent_mass(const TetMesh& mesh, double density) {
  PALPABLE_EXPECT(density > 0.0 && std::isfinite(density), "a density above 0");
  std::vector<Eigen::Triplet<double>> entries;
  const int A = mesh.is_quadratic() ? 10 : 4;
  entries.reserve(static_cast<std::size_t>(A) * static_cast<std::size_t>(A) *
                  static_cast<std::size_t>(mesh.tet_count()));
  const std::vector<WeightedPoint> rule = mass_rule();
  for (int e = 0; e < mesh.tet_count(); ++e) {
    if (mesh.is_quadratic()) {
      const Eigen::Matrix<int, 10, 1> nodes = quadratic_nodes(mesh, e);
      Eigen::Matrix<double, 10, 10> m = Eigen::Matrix<double, 10, 10>::Zero();
      for (const auto& [L, weight] : rule) {
        const QuadraticShape shape = quadratic_shape(L);
        const double mass = density * weight * quadratic_gradients(mesh, e, shape).volume;
        m += mass * shape.N * shape.N.transpose();
      }
      for (int a = 0; a < 10; ++a) {
        for (int b = 0; b < 10; ++b) entries.emplace_back(nodes[a], nodes[b], m(a, b));
      }
    } else {
      // int L_a L_b dV = V / 20 (1 + delta_ab).
      const double twentieth = density * shape_gradients(mesh, e).volume / 20.0;
      const Eigen::Vector4i nodes = mesh.tets.col(e);
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
          entries.emplace_back(nodes[a], nodes[b], twentieth * (a == b ? 2.0 : 1.0));
        }
      }
    }
  }
  SparseMatrix M(mesh.node_count(), mesh.node_count());
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

VibrationModes vibration_modes(const LoadResponse& body, double density,
                               const VibrationSettings& settings) {
  return vibration_modes(body, consistent_mass(body.model().mesh, density), settings);
}

VibrationModes vibration_modes(const LoadResponse& body, const SparseMatrix& M,
                               const VibrationSettings& settings) {
  PALPABLE_EXPECT(settings.least >= 1 && settings.most >= settings.least && settings.below >= 0,
                  "numbers of modes");
  Lanczos lanczos(body, M);
  Lanczos::Ritz ritz;
  Index modes = 0;
  while (modes == 0 && !lanczos.is_exhausted()) {
    lanczos.step();
    if (lanczos.size() < settings.least && !lanczos.is_exhausted()) continue;
    ritz = lanczos.ritz();
    modes = converged(lanczos, ritz, settings);
    if (modes == 0 && lanczos.size() > kLargestBasis * (settings.most + kBlockWidth)) {
      throw Error(fmt::format("no vibration modes were found in {} dimensions", lanczos.size()));
    }
  }

  // Shapes of the basis still have a share of high frequencies, small in M but not in K. A product
  // with A removes it: X = A V y, for which K X = M V y is known without another product.
  const MatrixXd MVy = mass_times(M, lanczos.basis() * ritz.y.leftCols(modes));
  const MatrixXd X = body.linear(MVy);
  MatrixXd small_K = X.transpose() * MVy, small_M = X.transpose() * mass_times(M, X);
  small_K = 0.5 * (small_K + small_K.transpose().eval());
  small_M = 0.5 * (small_M + small_M.transpose().eval());
  VibrationModes found{VectorXd(modes), MatrixXd(X.rows(), modes), VectorXd(modes)};
  if (modes == 0) return found;
  // Ascending omega^2; its vectors Y satisfy Y^T small_M Y = 1.
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> rotate(small_K, small_M);
  found.omega = rotate.eigenvalues().cwiseSqrt();
  found.shapes = X * rotate.eigenvectors();
  for (Index k = 0; k < modes; ++k) {
    auto phi = found.shapes.col(k);
    Index largest = 0;
    phi.cwiseAbs().maxCoeff(&largest);
    if (phi[largest] < 0) phi *= -1.0;
    const VectorXd K_phi = body.stiffness_times(phi).cwiseProduct(body.free_mask());
    const VectorXd M_phi = mass_times(M, phi).col(0).cwiseProduct(body.free_mask());
    found.residual[k] = (K_phi - found.omega[k] * found.omega[k] * M_phi).norm() / K_phi.norm();
    if (!(found.residual[k] <= kLargestEigenResidual)) {
      throw Error(fmt::format(
          "vibration mode {} of {} did not converge: its residual is {:.2g}, more than {:.0e}; "
          "modes = 0 in [touch] leaves modes out, and the body has no inertia",
          k + 1, modes, found.residual[k], kLargestEigenResidual));
    }
  }
  return found;
}

}  // namespace palpable
