#include "palpable/common/geometry/quadrature.h"

#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using test::tolerance;

// Over the unit simplex of dimension d, x^p y^q z^r integrates to p! q! r! / (p + q + r + d)!.
double monomial(int p, int q, int r, int d) {
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  return factorial(p) * factorial(q) * factorial(r) / factorial(p + q + r + d);
}

double sum(std::span<const QuadraturePoint> rule, int p, int q, int r) {
  double value = 0.0;
  for (const auto& [at, weight] : rule) {
    value += weight * std::pow(at[1], p) * std::pow(at[2], q) * std::pow(at[3], r);
  }
  return value;
}

TEST_CASE("each rule integrates the polynomials that it promises", "[geometry][quadrature]") {
  const double rounding = tolerance(1e-13, "rounding");
  for (int p = 0; p <= 4; ++p) {
    for (int q = 0; p + q <= 4; ++q) {
      INFO(p << " " << q);
      CHECK(sum(triangle_rule(), p, q, 0) / 2.0 == Approx(monomial(p, q, 0, 2)).epsilon(rounding));
      for (int r = 0; p + q + r <= 3; ++r) {
        CHECK(sum(tetrahedron_rule(), p, q, r) / 6.0 ==
              Approx(monomial(p, q, r, 3)).epsilon(rounding));
        if (p + q + r > 2) continue;
        CHECK(sum(four_point_rule(), p, q, r) / 6.0 ==
              Approx(monomial(p, q, r, 3)).epsilon(rounding));
      }
    }
  }
}

TEST_CASE("all points lie inside, with positive weights", "[geometry][quadrature]") {
  for (const std::span<const QuadraturePoint> rule :
       {std::span<const QuadraturePoint>(four_point_rule()), tetrahedron_rule(), triangle_rule()}) {
    for (const auto& [at, weight] : rule) {
      CHECK(at.minCoeff() >= 0.0);
      CHECK(at.sum() == Approx(1.0));
      CHECK(weight > 0.0);
    }
  }
}

}  // namespace
}  // namespace palpable
