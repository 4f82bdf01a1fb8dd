#include "palpable/common/material/saint_venant_kirchhoff.h"

#include "tests/support/test.h"

#include <Eigen/Dense>

#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using test::tolerance;

constexpr SaintVenantKirchhoff kSteel{.lambda = 1.1, .mu = 0.7};

TEST_CASE("a St. Venant-Kirchhoff bar in uniaxial strain has the stress of the closed form",
          "[material]") {
  // P11 = (lambda + 2 mu) / 2 (s^3 - s), P22 = P33 = lambda / 2 (s^2 - 1)
  for (const double s : {0.4, 0.8, 1.5}) {
    const Matrix3d P = first_piola(kSteel, Eigen::Vector3d(s, 1, 1).asDiagonal());
    const double axial = 0.5 * (kSteel.lambda + 2.0 * kSteel.mu) * (s * s * s - s);
    const double lateral = 0.5 * kSteel.lambda * (s * s - 1.0);
    const Matrix3d expected = Eigen::Vector3d(axial, lateral, lateral).asDiagonal();
    CHECK((P - expected).cwiseAbs().maxCoeff() <= tolerance(1e-14, "a few roundings"));
  }
}

TEST_CASE("St. Venant-Kirchhoff loses its stiffness at 1/sqrt(3) of the length", "[material]") {
  const auto stiffness = [](double s) {
    return tangent(kSteel, Eigen::Vector3d(s, 1, 1).asDiagonal())(0, 0);
  };
  const double s = 1.0 / std::sqrt(3.0);
  CHECK(stiffness(s + 0.01) > 0.0);
  CHECK(stiffness(s - 0.01) < 0.0);
}

}  // namespace
}  // namespace palpable
