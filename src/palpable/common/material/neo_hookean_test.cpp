#include "palpable/common/material/neo_hookean.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using test::tolerance;

constexpr NeoHookean kRubber{.C1 = 0.6, .D1 = 1.7};  // Pa; of order one, so that tolerances are too

double largest(const Matrix3d& A) { return A.cwiseAbs().maxCoeff(); }

TEST_CASE("eq. (7) as printed is not free of stress at rest, with the full I1 it is",
          "[material][Eq7]") {
  const auto printed = [](const Matrix3d& F) {
    const double J = F.determinant(), ln_J = std::log(J);
    const double I1_bar = std::pow(J, -2.0 / 3.0) * F.squaredNorm();
    return kRubber.C1 * (I1_bar - 3.0 - 2.0 * ln_J) + kRubber.D1 * ln_J * ln_J;
  };
  const double h = 1e-5;
  Matrix3d P_printed;
  for (int k = 0; k < 9; ++k) {
    Matrix3d up = Matrix3d::Identity(), down = up;
    up(k) += h;
    down(k) -= h;
    P_printed(k) = (printed(up) - printed(down)) / (2.0 * h);
  }
  CHECK(largest(P_printed + 2.0 * kRubber.C1 * Matrix3d::Identity()) <=
        tolerance(1e-8, "central differences with h = 1e-5"));
  CHECK(largest(first_piola(kRubber, Matrix3d::Identity())) == 0.0);
}

TEST_CASE("a neo-Hookean change of size has the stress of the closed form", "[material][Eq7]") {
  const double s = 1.3;  // F = s I, so J = s^3
  const double expected =
      2.0 * kRubber.C1 * (s - 1.0 / s) + 2.0 * kRubber.D1 * 3.0 * std::log(s) / s;
  const Matrix3d P = first_piola(kRubber, s * Matrix3d::Identity());
  CHECK(largest(P - expected * Matrix3d::Identity()) <= tolerance(1e-14, "a few roundings"));
}

TEST_CASE("a neo-Hookean element that is inverted has no stress", "[material][errors]") {
  const Matrix3d F = Eigen::Vector3d(1, 1, -0.5).asDiagonal();
  CHECK_THROWS_AS(first_piola(kRubber, F), ContractViolation);
  CHECK_THROWS_AS(tangent(kRubber, F), ContractViolation);
}

}  // namespace
}  // namespace palpable
