#include "palpable/bake/solid/energy_tensors.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using test::tolerance;

Matrix3d some_matrix(unsigned seed, double size) {
  auto random = test::random_case(seed);
  std::uniform_real_distribution<double> entry(-size, size);
  return Matrix3d::NullaryExpr([&] { return entry(random); });
}

// T(u, v, w), T(u, v, w, x) by sums over all entries.
double third_of(const FullEnergyTensors& t, const Matrix3d& u, const Matrix3d& v,
                const Matrix3d& w) {
  double sum = 0;
  for (int a = 0; a < 9; ++a) {
    for (int b = 0; b < 9; ++b) {
      for (int c = 0; c < 9; ++c) sum += t.third[81 * a + 9 * b + c] * u(a) * v(b) * w(c);
    }
  }
  return sum;
}
double fourth_of(const FullEnergyTensors& t, const Matrix3d& u, const Matrix3d& v,
                 const Matrix3d& w, const Matrix3d& x) {
  double sum = 0;
  for (int a = 0; a < 9; ++a) {
    for (int b = 0; b < 9; ++b) {
      for (int c = 0; c < 9; ++c) {
        for (int d = 0; d < 9; ++d) {
          sum += t.fourth[729 * a + 81 * b + 9 * c + d] * u(a) * v(b) * w(c) * x(d);
        }
      }
    }
  }
  return sum;
}

// u . dP/dF . v at F
double second_of(const Material& law, const Matrix3d& F, const Matrix3d& u, const Matrix3d& v) {
  return u.reshaped().dot(tangent(law, F) * v.reshaped());
}

TEST_CASE("third and fourth derivatives are those of the tangent, for every law", "[solid][law]") {
  const double h = 1e-3;
  for (const std::string& name : law_names()) {
    const Material law = material_from_young(name, 2.5, 0.35);
    for (unsigned seed = 0; seed < 6; ++seed) {
      INFO(name << ", seed " << seed);
      const Matrix3d F = Matrix3d::Identity() + some_matrix(seed, seed == 0 ? 0.0 : 0.2);
      const FullEnergyTensors t = unfolded(energy_tensors(law, F));
      const Matrix3d u = some_matrix(10 + seed, 1), v = some_matrix(20 + seed, 1),
                     w = some_matrix(30 + seed, 1), x = some_matrix(40 + seed, 1);
      const auto at = [&](double a, double b) { return second_of(law, F + a * w + b * x, u, v); };
      // Central differences of fourth order.
      const double third = (8 * (at(h, 0) - at(-h, 0)) - (at(2 * h, 0) - at(-2 * h, 0))) / (12 * h);
      CHECK(third_of(t, u, v, w) ==
            Approx(third).margin(tolerance(1e-8, "h^4 of the seventh derivative, rounding / h")));
      const auto slope = [&](double b) {
        return (8 * (at(h, b) - at(-h, b)) - (at(2 * h, b) - at(-2 * h, b))) / (12 * h);
      };
      const double fourth =
          (8 * (slope(h) - slope(-h)) - (slope(2 * h) - slope(-2 * h))) / (12 * h);
      CHECK(fourth_of(t, u, v, w, x) ==
            Approx(fourth).margin(tolerance(2e-5, "rounding / h^2 and h^4 of the eighth")));
    }
  }
}

TEST_CASE("an inverted element has no derivatives", "[solid][law][errors]") {
  const Matrix3d F = Eigen::Vector3d(1, 1, -0.5).asDiagonal();
  CHECK_THROWS_AS(energy_tensors(NeoHookean{1, 1}, F), ContractViolation);
}

}  // namespace
}  // namespace palpable
