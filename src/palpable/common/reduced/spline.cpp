#include "palpable/common/reduced/spline.h"

#include "palpable/common/base/contract.h"

#include <algorithm>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

MatrixXd spline_slopes(const VectorXd& x, const MatrixXd& g) {
  PALPABLE_EXPECT(g.rows() == x.size(), "one row of values per sample");
  const Index n = x.size();
  if (n == 1) return MatrixXd::Zero(1, g.cols());
  const VectorXd h = x.tail(n - 1) - x.head(n - 1);
  const MatrixXd secant =
      (g.bottomRows(n - 1) - g.topRows(n - 1)).array().colwise() / h.array();  // (n - 1 x m)
  if (n == 2) return secant.replicate(2, 1);
  if (n == 3) {  // the parabola
    const RowVectorXd curvature = (secant.row(1) - secant.row(0)) / (h[0] + h[1]);
    MatrixXd slopes(3, g.cols());
    slopes << secant.row(0) - h[0] * curvature, secant.row(0) + h[0] * curvature,
        secant.row(1) + h[1] * curvature;
    return slopes;
  }
  // Equal second derivatives at an inner sample k:
  //   h_k s_(k-1) + 2 (h_(k-1) + h_k) s_k + h_(k-1) s_(k+1) = 3 (h_k d_(k-1) + h_(k-1) d_k)
  // and equal third derivatives at the second sample and the last but one (not-a-knot), by which
  // the third unknown of the first and the last row is eliminated. d: slopes of the secants.
  VectorXd lower = VectorXd::Zero(n), middle(n), upper = VectorXd::Zero(n);
  MatrixXd s(n, g.cols());
  middle[0] = h[1];
  upper[0] = h[0] + h[1];
  s.row(0) =
      ((h[0] + 2.0 * upper[0]) * h[1] * secant.row(0) + h[0] * h[0] * secant.row(1)) / upper[0];
  for (Index k = 1; k + 1 < n; ++k) {
    lower[k] = h[k];
    middle[k] = 2.0 * (h[k - 1] + h[k]);
    upper[k] = h[k - 1];
    s.row(k) = 3.0 * (h[k] * secant.row(k - 1) + h[k - 1] * secant.row(k));
  }
  const double a = h[n - 3], b = h[n - 2];
  lower[n - 1] = a + b;
  middle[n - 1] = a;
  s.row(n - 1) =
      (b * b * secant.row(n - 3) + (2.0 * (a + b) + b) * a * secant.row(n - 2)) / lower[n - 1];
  for (Index k = 1; k < n; ++k) {
    const double factor = lower[k] / middle[k - 1];
    middle[k] -= factor * upper[k - 1];
    s.row(k) -= factor * s.row(k - 1);
  }
  s.row(n - 1) /= middle[n - 1];
  for (Index k = n - 2; k >= 0; --k) s.row(k) = (s.row(k) - upper[k] * s.row(k + 1)) / middle[k];
  return s;
}

MatrixXd increasing_slopes(const VectorXd& x, const MatrixXd& g) {
  MatrixXd slopes = spline_slopes(x, g);
  const Index n = x.size();
  for (Index i = 0; i < g.cols(); ++i) {
    for (Index k = 0; k + 1 < n; ++k) {
      const double most = 3.0 * (g(k + 1, i) - g(k, i)) / (x[k + 1] - x[k]);
      for (const Index end : {k, k + 1}) slopes(end, i) = std::clamp(slopes(end, i), 0.0, most);
    }
  }
  return slopes;
}

CubicWeights cubic_weights(const Eigen::Ref<const VectorXd>& x, double at) {
  PALPABLE_EXPECT(at == at, "a parameter is a number");
  const Index last = x.size() - 1;
  CubicWeights weights;
  if (at < x[0] || last == 0) return weights;
  const double* first = x.data();
  const Index k = at > x[last] ? last : std::upper_bound(first, first + last + 1, at) - first - 1;
  weights.left = weights.right = k;
  if (x[k] == at) weights.slope[1] = 1;
  if (x[k] == at || k == last) return weights;

  weights.right = k + 1;
  const double h = x[k + 1] - x[k], t = (at - x[k]) / h, u = 1 - t;
  weights.value[0] = u * u * (1 + 2 * t);
  weights.value[1] = u * u * t * h;
  weights.value[2] = t * t * (3 - 2 * t);
  weights.value[3] = -t * t * u * h;
  weights.slope[0] = -6 * t * u / h;
  weights.slope[1] = u * (1 - 3 * t);
  weights.slope[2] = 6 * t * u / h;
  weights.slope[3] = t * (3 * t - 2);
  return weights;
}

}  // namespace palpable
