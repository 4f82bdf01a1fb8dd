// Tests of this law alone; those that every law must pass are in material_test.cpp.
#include "palpable/common/material/neo_hookean_abaqus.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using test::tolerance;

constexpr NeoHookeanAbaqus kRubber{.C10 = 0.6, .D1 = 0.8};  // of order one: tolerances are too

double largest(const Eigen::MatrixXd& A) { return A.cwiseAbs().maxCoeff(); }

TEST_CASE("a change of size alone is resisted by the bulk term alone", "[material][abaqus]") {
  const double s = 1.3, J = s * s * s;  // F = s I
  const Matrix3d F = s * Matrix3d::Identity();
  CHECK(energy_density(kRubber, F) ==
        Approx((J - 1) * (J - 1) / kRubber.D1).epsilon(tolerance(1e-14, "a few roundings")));
  // Cauchy stress is the pressure 2/D1 (J - 1) in all directions; P = J sigma F^-T
  const Matrix3d expected = 2.0 / kRubber.D1 * (J - 1) * J / s * Matrix3d::Identity();
  CHECK(largest(first_piola(kRubber, F) - expected) <= tolerance(1e-14, "a few roundings"));
}

TEST_CASE("in uniaxial strain the Abaqus form has the stress of the closed form",
          "[material][abaqus]") {
  // F = diag(s, 1, 1): Psi(s) = C10 (s^(4/3) + 2 s^(-2/3) - 3) + (s - 1)^2 / D1
  for (const double s : {0.3, 0.8, 1.5}) {
    INFO("stretch " << s);
    const Matrix3d F = Eigen::Vector3d(s, 1, 1).asDiagonal();
    const double P11 = kRubber.C10 * 4.0 / 3.0 * (std::cbrt(s) - std::pow(s, -5.0 / 3.0)) +
                       2.0 * (s - 1.0) / kRubber.D1;
    CHECK(first_piola(kRubber, F)(0, 0) ==
          Approx(P11).epsilon(tolerance(1e-14, "a few roundings")));
  }
}

TEST_CASE("only the change of shape makes a shear stress in the Abaqus form",
          "[material][abaqus]") {
  // Simple shear keeps J = 1, so Cauchy stress 12 is 2 C10 times the amount of shear, as in the
  // manuals of Abaqus and CalculiX for incompressible rubber.
  const double amount = 0.7;
  Matrix3d F = Matrix3d::Identity();
  F(0, 1) = amount;
  const Matrix3d sigma = first_piola(kRubber, F) * F.transpose();
  CHECK(sigma(0, 1) == Approx(2.0 * kRubber.C10 * amount));
  CHECK(sigma.trace() == Approx(0.0).margin(tolerance(1e-14, "a few roundings")));
}

TEST_CASE("an inverted element has no stress in the Abaqus form", "[material][abaqus][errors]") {
  const Matrix3d F = Eigen::Vector3d(1, 1, -0.5).asDiagonal();
  CHECK_THROWS_AS(first_piola(kRubber, F), ContractViolation);
  CHECK_THROWS_AS(tangent(kRubber, F), ContractViolation);
}

}  // namespace
}  // namespace palpable
