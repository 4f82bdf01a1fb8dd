#include "palpable/common/reduced/spline.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/LU>

#include <cmath>
#include <functional>

namespace palpable {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

double at(const VectorXd& x, const VectorXd& g, const VectorXd& s, double t, bool slope = false) {
  const CubicWeights c = cubic_weights(x, t);
  const double* w = slope ? c.slope : c.value;
  return w[0] * g[c.left] + w[1] * s[c.left] + w[2] * g[c.right] + w[3] * s[c.right];
}

VectorXd uneven() {
  VectorXd x(6);
  x << 0, 0.3, 0.4, 0.8, 0.9, 1.5;
  return x;
}

TEST_CASE("the spline is exact for cubics, on uneven samples and at both ends", "[reduced]") {
  const auto cubic = [](double x) { return 2 - 3 * x + 5 * x * x - 4 * x * x * x; };
  const auto slope = [](double x) { return -3 + 10 * x - 12 * x * x; };
  for (const Eigen::Index n : {4, 5, 6}) {
    const VectorXd x = uneven().head(n), g = x.unaryExpr(cubic), s = spline_slopes(x, g);
    for (double t = 0; t <= x[n - 1]; t += 0.01) {
      CHECK(std::abs(at(x, g, s, t) - cubic(t)) <= tolerance(1e-13, "rounding"));
      CHECK(std::abs(at(x, g, s, t, true) - slope(t)) <= tolerance(1e-12, "rounding over 0.1"));
    }
  }
}

TEST_CASE("few samples give the parabola, the line and the constant", "[reduced]") {
  const auto parabola = [](double x) { return 1 + x - 2 * x * x; };
  const VectorXd x = uneven().head(3), g = x.unaryExpr(parabola), s = spline_slopes(x, g);
  for (double t = 0; t <= 0.4; t += 0.01) {
    CHECK(std::abs(at(x, g, s, t) - parabola(t)) <= tolerance(1e-14, "rounding"));
  }
  const VectorXd line = spline_slopes(x.head(2), g.head(2));
  CHECK(std::abs(at(x.head(2), g.head(2), line, 0.1) - (g[0] * 2 + g[1]) / 3) <=
        tolerance(1e-15, "rounding"));
  CHECK(at(x.head(1), g.head(1), spline_slopes(x.head(1), g.head(1)), 7) == 1);
}

// Largest error of the interpolation of `truth` from n + 1 samples of [0, 1].
double worst_error(int n, const std::function<double(double)>& truth, bool natural = false) {
  const VectorXd x = VectorXd::LinSpaced(n + 1, 0, 1), g = x.unaryExpr(truth);
  VectorXd s = spline_slopes(x, g);
  if (natural) {  // the textbook's natural spline: no curvature at the ends
    MatrixXd A = MatrixXd::Zero(n + 1, n + 1);
    VectorXd b(n + 1);
    A(0, 0) = A(n, n) = 2;
    A(0, 1) = A(n, n - 1) = 1;
    b[0] = 3 * n * (g[1] - g[0]);
    b[n] = 3 * n * (g[n] - g[n - 1]);
    for (int k = 1; k < n; ++k) {
      A(k, k - 1) = A(k, k + 1) = 1;
      A(k, k) = 4;
      b[k] = 3 * n * (g[k + 1] - g[k - 1]);
    }
    s = A.partialPivLu().solve(b);
  }
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    const double t = (k + 0.5) / 1000;
    worst = std::max(worst, std::abs(at(x, g, s, t) - truth(t)));
  }
  return worst;
}

TEST_CASE("the error of interpolation falls with the fourth power of the spacing", "[reduced]") {
  // Shapes of equilibrium paths: a stiffening and a softening one.
  for (const auto& truth :
       {std::function<double(double)>([](double x) { return std::exp(2 * x); }),
        std::function<double(double)>([](double x) { return std::sqrt(1 + 2 * x); })}) {
    const double order = std::log2(worst_error(52, truth) / worst_error(104, truth));
    INFO("order " << order);
    CHECK(order > 4 - tolerance(0.3, "the end intervals approach their order from below"));
    CHECK(3 * worst_error(26, truth) < worst_error(26, truth, true));
  }
}

TEST_CASE("neither the slope nor the curvature has a jump", "[reduced]") {
  const VectorXd x = uneven();
  VectorXd g(6);
  g << 0, 1, 0.5, 0.6, -1, 2;
  const VectorXd s = spline_slopes(x, g);
  const auto curvature = [&](double t) {
    const double h = 1e-4;
    return (at(x, g, s, t + h, true) - at(x, g, s, t - h, true)) / (2 * h);
  };
  for (Eigen::Index k = 1; k < 5; ++k) {
    const double h = 1e-9;
    CHECK(std::abs(at(x, g, s, x[k] + h, true) - at(x, g, s, x[k] - h, true)) <=
          tolerance(1e-5, "h times curvatures of up to 1000"));
    CHECK(std::abs(curvature(x[k] + 2e-4) - curvature(x[k] - 2e-4)) <=
          tolerance(20, "4e-4 times third derivatives of up to 4e4"));
  }
}

TEST_CASE("slopes of several functions are the slopes of each", "[reduced]") {
  const VectorXd x = uneven();
  MatrixXd g(6, 2);
  g << x, x.cwiseAbs2();
  CHECK(spline_slopes(x, g).col(1) == spline_slopes(x, g.col(1)));
}

TEST_CASE("a function that increases at the samples increases between them", "[reduced][law]") {
  for (unsigned seed = 0; seed < 200; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> number(0, 1);
    VectorXd x(9), g(9);
    x[0] = g[0] = 0;
    for (Eigen::Index k = 1; k < 9; ++k) {  // steps that differ by up to a thousand
      x[k] = x[k - 1] + std::pow(10, -3 * number(random));
      g[k] = g[k - 1] + std::pow(10, -3 * number(random));
    }
    const VectorXd s = increasing_slopes(x, g);
    double before = -1;
    bool increases = true;
    for (int i = 0; i <= 4000; ++i) {
      const double value = at(x, g, s, x[8] * i / 4000);
      increases &= value > before;
      before = value;
    }
    CHECK(increases);
    CHECK(before == g[8]);
  }
}

TEST_CASE("slopes within the limit are not changed", "[reduced]") {
  const VectorXd x = uneven(), g = x.array().exp();
  CHECK(increasing_slopes(x, g) == spline_slopes(x, g));
}

TEST_CASE("a function is constant beyond its samples, and NaN is refused", "[reduced]") {
  const VectorXd x = uneven(), g = x.array().exp(), s = spline_slopes(x, g);
  CHECK(at(x, g, s, -1) == g[0]);
  CHECK(at(x, g, s, 9) == g[5]);
  CHECK(at(x, g, s, 9, true) == 0);
  CHECK(at(x, g, s, -1, true) == 0);
  CHECK(at(x, g, s, 1.5, true) == s[5]);
  CHECK(at(x, g, s, 0, true) == s[0]);
  CHECK_THROWS_AS(cubic_weights(x, NAN), ContractViolation);
  CHECK(test::allocations_during([&] { (void)cubic_weights(x, 0.35); }) == 0);
}

}  // namespace
}  // namespace palpable
