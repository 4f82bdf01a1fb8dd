// Tests of this law alone; those that every law must pass are in material_test.cpp.
#include "palpable/common/material/mooney_rivlin.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/material/material.h"
#include "palpable/common/material/neo_hookean.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using test::tolerance;

constexpr MooneyRivlin kRubber{.C1 = 0.6, .C2 = 0.25, .D1 = 1.3};  // of order one

double largest(const Eigen::MatrixXd& A) { return A.cwiseAbs().maxCoeff(); }

TEST_CASE("Mooney-Rivlin without the second invariant is neo-Hookean",
          "[material][mooney-rivlin]") {
  Matrix3d F;
  F << 1.2, 0.1, 0.0, -0.2, 0.9, 0.3, 0.0, 0.1, 1.1;
  const MooneyRivlin a{.C1 = 0.6, .C2 = 0.0, .D1 = 1.7};
  const NeoHookean b{.C1 = 0.6, .D1 = 1.7};
  const double rounding = tolerance(1e-14, "a few roundings");
  CHECK(energy_density(a, F) == Approx(energy_density(b, F)).epsilon(rounding));
  CHECK(largest(first_piola(a, F) - first_piola(b, F)) <= rounding);
  CHECK(largest(tangent(a, F) - tangent(b, F)) <= rounding);
}

TEST_CASE("simple shear of Mooney-Rivlin rubber has the stresses of Rivlin's solution",
          "[material][mooney-rivlin]") {
  // J = 1: sigma_12 = 2 (C1 + C2) s, sigma_11 - sigma_22 = s sigma_12 (universal), and the second
  // invariant makes sigma_33 - sigma_22 = 2 C2 s^2.
  const double s = 0.7;
  Matrix3d F = Matrix3d::Identity();
  F(0, 1) = s;
  const Matrix3d sigma = first_piola(kRubber, F) * F.transpose();
  CHECK(sigma(0, 1) == Approx(2.0 * (kRubber.C1 + kRubber.C2) * s));
  CHECK(sigma(0, 0) - sigma(1, 1) == Approx(s * sigma(0, 1)));
  CHECK(sigma(2, 2) - sigma(1, 1) == Approx(2.0 * kRubber.C2 * s * s));
}

TEST_CASE("a Mooney-Rivlin change of size has the stress of the closed form",
          "[material][mooney-rivlin]") {
  // F = s I: Psi(s) = 3 C1 (s^2 - 1 - 2 ln s) + 3 C2 (s^4 - 1 - 4 ln s) + 9 D1 (ln s)^2 and
  // P = Psi'(s) / 3.
  for (const double s : {0.6, 1.3}) {
    const double P = kRubber.C1 * (2 * s - 2 / s) + kRubber.C2 * (4 * s * s * s - 4 / s) +
                     6 * kRubber.D1 * std::log(s) / s;
    CHECK(largest(first_piola(kRubber, s * Matrix3d::Identity()) - P * Matrix3d::Identity()) <=
          tolerance(1e-14, "a few roundings"));
  }
}

TEST_CASE("constants of Mooney-Rivlin that soften under shear are refused",
          "[material][mooney-rivlin][errors]") {
  CHECK_NOTHROW(check_material(kRubber));
  CHECK_THROWS_AS(check_material(MooneyRivlin{.C1 = 0.5, .C2 = -0.1, .D1 = 1}), Error);
  CHECK_THROWS_AS(check_material(MooneyRivlin{.C1 = -0.1, .C2 = 0.5, .D1 = 1}), Error);
  CHECK_THROWS_AS(check_material(MooneyRivlin{.C1 = 0, .C2 = 0, .D1 = 1}), Error);
}

TEST_CASE("an inverted element has no stress under Mooney-Rivlin",
          "[material][mooney-rivlin][errors]") {
  const Matrix3d F = Eigen::Vector3d(1, 1, -0.5).asDiagonal();
  CHECK_THROWS_AS(first_piola(kRubber, F), ContractViolation);
  CHECK_THROWS_AS(tangent(kRubber, F), ContractViolation);
}

}  // namespace
}  // namespace palpable
