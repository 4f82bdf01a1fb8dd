#include "palpable/bake/intrusive/linear_pgd.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

LinearPgd linear_pgd(const LoadSeries& body, const Eigen::SparseMatrix<double>& loads,
                     const VectorXd& weights, PositionStep step, int modes) {
  PALPABLE_EXPECT(weights.size() == loads.cols() && weights.minCoeff() > 0.0, "a weight > 0 each");
  PALPABLE_EXPECT(1 <= modes && modes <= loads.cols(), "1 to S modes");
  const VectorXd& M = body.mass();
  LinearPgd pgd{MatrixXd(loads.rows(), modes), MatrixXd(loads.cols(), modes), 0};
  MatrixXd KF(loads.rows(), modes);  // K F_i, or M F_i with the adjoint; F is orthogonal to them
  const auto solve = [&](const VectorXd& b) -> VectorXd {
    ++pgd.solves;
    return body.linear_response(b);
  };
  for (Index i = 0; i < modes; ++i) {
    const auto F_before = pgd.F.leftCols(i), KF_before = KF.leftCols(i);
    const auto G_before = pgd.G.leftCols(i);
    // Any start that is not orthogonal to the mode will do; this one grows with the number of the
    // position.
    VectorXd g = VectorXd::LinSpaced(loads.cols(), 1.0, 2.0);
    VectorXd F, metric;
    for (int turn = 0; turn < 30; ++turn) {
      // x-step: K F = sum_s w g (f - sum_i K F_i G_i)
      const VectorXd wg = weights.cwiseProduct(g);
      const VectorXd b = loads * wg;
      const VectorXd known = G_before.transpose() * wg;
      F = solve(b) - F_before * known;
      if (step == PositionStep::kAdjoint) {
        // Without this, rounding would let the previous modes grow back.
        F -= F_before * (KF_before.transpose() * F);
        metric = M.cwiseProduct(F);
      } else {
        const VectorXd again = KF_before.transpose() * F;
        F -= F_before * again;
        metric = (b - KF_before * (known + again)).cwiseProduct(body.free_mask());
      }
      const double length = std::sqrt(F.dot(metric));
      F /= length;
      metric /= length;
      // s-step. F is orthogonal to the previous modes, so that their G do not appear.
      const VectorXd before = g / g.norm();
      g = loads.transpose() * (step == PositionStep::kAdjoint ? solve(metric) : F);
      if ((g / g.norm() - before).norm() < 0.01) break;
    }
    pgd.F.col(i) = F;
    KF.col(i) = metric;
    pgd.G.col(i) = g;
  }
  return pgd;
}

LinearErrors linear_errors(const LoadSeries& body, const Eigen::SparseMatrix<double>& loads,
                           const VectorXd& weights, const LinearPgd& pgd) {
  const Index m = pgd.F.cols();
  const MatrixXd MF = body.mass().asDiagonal() * pgd.F;
  const MatrixXd FMF = pgd.F.transpose() * MF;
  // |u - sum F G|^2 = |u|^2 - 2 sum G_i <F_i, u> + sum G_i G_j <F_i, F_j>, and K F . u = F . f.
  double l2_whole = 0.0, energy_whole = 0.0;
  VectorXd l2 = VectorXd::Zero(m), energy = VectorXd::Zero(m);
  MatrixXd FKF(m, m);
  for (Index i = 0; i < m; ++i) {
    FKF.col(i) = pgd.F.transpose() * body.stiffness_times(pgd.F.col(i));
  }
  constexpr Index kBlock = 64;
  for (Index first = 0; first < loads.cols(); first += kBlock) {
    const Index count = std::min(kBlock, loads.cols() - first);
    const MatrixXd f = loads.middleCols(first, count);
    const MatrixXd u = body.linear_response(f);
    const MatrixXd in_l2 = MF.transpose() * u, in_energy = pgd.F.transpose() * f;
    for (Index c = 0; c < count; ++c) {
      const double w = weights[first + c];
      const VectorXd G = pgd.G.row(first + c);
      const double u_u = u.col(c).dot(body.mass().cwiseProduct(u.col(c)));
      const double u_f = u.col(c).dot(f.col(c));
      l2_whole += w * u_u;
      energy_whole += w * u_f;
      for (Index k = 1; k <= m; ++k) {
        const auto g = G.head(k);
        l2[k - 1] +=
            w * (u_u - 2.0 * g.dot(in_l2.col(c).head(k)) + g.dot(FMF.topLeftCorner(k, k) * g));
        energy[k - 1] +=
            w * (u_f - 2.0 * g.dot(in_energy.col(c).head(k)) + g.dot(FKF.topLeftCorner(k, k) * g));
      }
    }
  }
  return {(l2 / l2_whole).cwiseMax(0.0).cwiseSqrt(),
          (energy / energy_whole).cwiseMax(0.0).cwiseSqrt()};
}

}  // namespace palpable
