// What every law must satisfy, and how a law is chosen by name.
#include "palpable/common/material/material.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <cmath>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3d;
using test::tolerance;

// Constants are of order one, so that tolerances are absolute and relative at the same time.
std::vector<Material> all_laws() {
  std::vector<Material> laws;
  for (const std::string& name : law_names()) laws.push_back(material_from_young(name, 2.5, 0.35));
  return laws;
}

// A deformation of tens of percent with J > 0.
Matrix3d some_deformation(unsigned seed) {
  auto random = test::random_case(seed);
  std::uniform_real_distribution<double> entry(-0.25, 0.25);
  return Matrix3d::Identity() + Matrix3d::NullaryExpr([&] { return entry(random); });
}

Matrix3d some_rotation(unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<double> entry;
  const Eigen::Vector4d q = Eigen::Vector4d::NullaryExpr([&] { return entry(random); });
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

double largest(const Eigen::MatrixXd& A) { return A.cwiseAbs().maxCoeff(); }

TEST_CASE("a body at rest carries no stress and stores no energy", "[material][law][Eq7]") {
  for (const Material& law : all_laws()) {
    INFO(law_name(law));
    CHECK(energy_density(law, Matrix3d::Identity()) == 0.0);
    CHECK(largest(first_piola(law, Matrix3d::Identity())) == 0.0);
  }
}

TEST_CASE("the stress is the derivative of the energy", "[material][law][Eq7]") {
  const double h = 1e-6;
  for (const Material& law : all_laws()) {
    for (unsigned seed = 0; seed < 25; ++seed) {
      INFO(law_name(law) << ", seed " << seed);
      const Matrix3d F = some_deformation(seed);
      Matrix3d P;
      for (int k = 0; k < 9; ++k) {
        Matrix3d up = F, down = F;
        up(k) += h;
        down(k) -= h;
        P(k) = (energy_density(law, up) - energy_density(law, down)) / (2.0 * h);
      }
      CHECK(largest(first_piola(law, F) - P) <=
            tolerance(2e-9, "rounding of Psi divided by h = 1e-6"));
    }
  }
}

TEST_CASE("the tangent is the derivative of the stress, in the documented layout",
          "[material][law]") {
  const double h = 1e-6;
  for (const Material& law : all_laws()) {
    for (unsigned seed = 0; seed < 25; ++seed) {
      INFO(law_name(law) << ", seed " << seed);
      const Matrix3d F = some_deformation(seed);
      Tangent A;
      for (int L = 0; L < 3; ++L) {
        for (int k = 0; k < 3; ++k) {
          Matrix3d up = F, down = F;
          up(k, L) += h;
          down(k, L) -= h;
          const Matrix3d dP = (first_piola(law, up) - first_piola(law, down)) / (2.0 * h);
          for (int J = 0; J < 3; ++J) {
            for (int i = 0; i < 3; ++i) A(i + 3 * J, k + 3 * L) = dP(i, J);
          }
        }
      }
      CHECK(largest(tangent(law, F) - A) <= tolerance(1e-8, "rounding of P divided by h = 1e-6"));
      CHECK(largest(tangent(law, F) - tangent(law, F).transpose()) <=
            tolerance(1e-13, "the same sums in another order"));
    }
  }
}

TEST_CASE("the energy does not change when the body is rotated, and the stress rotates with it",
          "[material][law]") {
  for (const Material& law : all_laws()) {
    for (unsigned seed = 0; seed < 25; ++seed) {
      INFO(law_name(law) << ", seed " << seed);
      const Matrix3d F = some_deformation(seed);
      const Matrix3d Q = some_rotation(seed);
      const double Psi = energy_density(law, F);
      const double rounding = tolerance(1e-12, "three matrix products of numbers near 1");
      CHECK(std::abs(energy_density(law, Q * F) - Psi) <= rounding);  // frame indifference
      CHECK(std::abs(energy_density(law, F * Q) - Psi) <= rounding);  // isotropy
      CHECK(largest(first_piola(law, Q * F) - Q * first_piola(law, F)) <= rounding);
      const Matrix3d sigma_J = first_piola(law, F) * F.transpose();
      CHECK(largest(sigma_J - sigma_J.transpose()) <= rounding);  // balance of moments
    }
  }
}

TEST_CASE(
    "small strains give linear elasticity with the Young's modulus and Poisson's ratio asked "
    "for",
    "[material][law][limit]") {
  const double E = 2.5, nu = 0.35;
  const Matrix3d G = some_deformation(3) - Matrix3d::Identity();
  const Matrix3d strain = 0.5 * (G + G.transpose());
  // Hooke: strain = ((1 + nu) sigma - nu tr(sigma) I) / E, checked by putting sigma back in.
  for (const Material& law : all_laws()) {
    INFO(law_name(law));
    const auto error = [&](double s) {
      const Matrix3d sigma = first_piola(law, Matrix3d::Identity() + s * G) / s;
      return largest(((1.0 + nu) * sigma - nu * sigma.trace() * Matrix3d::Identity()) / E - strain);
    };
    CHECK(error(1e-4) <= tolerance(1e-3, "first order in s = 1e-4 times constants of order one"));
    const double order = std::log2(error(2e-3) / error(1e-3));  // the error falls linearly with s
    CHECK(order == Approx(1.0).margin(tolerance(1e-2, "next term of the expansion, s = 1e-3")));
  }
}

TEST_CASE("an inverted element has infinite energy under every law", "[material][law][errors]") {
  for (const Material& law : all_laws()) {
    CHECK(std::isinf(energy_density(law, Eigen::Vector3d(1, 1, -0.5).asDiagonal())));
    CHECK(std::isinf(energy_density(law, Eigen::Vector3d(1, 1, 0).asDiagonal())));
  }
}

TEST_CASE("a law has the name by which it was chosen", "[material]") {
  for (const std::string& name : law_names()) {
    CHECK(law_name(material_from_young(name, 1e5, 0.3)) == name);
  }
}

TEST_CASE("every law's own constants make the material that Young's modulus makes", "[material]") {
  for (const std::string& name : law_names()) {
    INFO(name);
    const Material material = material_from_young(name, 60e3, 0.35);
    const auto values = std::visit(
        [](const auto& law) {
          // A law's struct consists of its constants.
          const auto* first = reinterpret_cast<const double*>(&law);
          return std::vector<double>(first, first + law.kConstants.size());
        },
        material);
    const Material again = material_from_constants(name, values);
    CHECK(law_name(again) == name);
    const Matrix3d F = some_deformation(5);
    CHECK(first_piola(again, F) == first_piola(material, F));
    const auto [young, poisson] = young_poisson(again);
    CHECK(young == Approx(60e3).epsilon(tolerance(1e-12, "rounding")));
    CHECK(poisson == Approx(0.35).epsilon(tolerance(1e-12, "rounding")));
  }
  CHECK_THROWS_WITH(material_from_constants("neo-hookean", std::vector{-1.0, 1.0}),
                    Contains("C1 = -1 Pa") && Contains("above 0"));
  CHECK_THROWS_WITH(material_from_constants("mooney-rivlin", std::vector{0.0, 0.0, 1.0}),
                    Contains("mu = 0"));
}

TEST_CASE("a material out of range is refused with the value and the limit", "[material][errors]") {
  CHECK_THROWS_WITH(material_from_young("neo-hookean", 6e4, 0.5),
                    Contains("0.5") && Contains("below 0.5"));
  CHECK_THROWS_WITH(material_from_young("neo-hookean", 6e4, -0.1), Contains("-0.1"));
  CHECK_THROWS_WITH(material_from_young("neo-hookean", 6e4, std::nan("")), Contains("nan"));
  CHECK_THROWS_WITH(material_from_young("neo-hookean", 0.0, 0.3), Contains("Young's modulus is 0"));
  CHECK_THROWS_WITH(material_from_young("neo-hookean", -5.0, 0.3), Contains("-5"));
  CHECK_THROWS_WITH(material_from_young("jelly", 1.0, 0.3),
                    Contains("\"jelly\"") && Contains("\"neo-hookean\"") &&
                        Contains("\"saint-venant-kirchhoff\""));
  CHECK_THROWS_WITH(check_material(NeoHookean{.C1 = 0.0, .D1 = 1.0}), Contains("C1 = 0"));
  CHECK_THROWS_WITH(check_material(SaintVenantKirchhoff{.lambda = -1.0, .mu = 1.0}),
                    Contains("lambda = -1"));
}

TEST_CASE("Poisson's ratio is written so that its distance from 0.5 can be told", "[material]") {
  CHECK(poisson_text(0.4) == "0.4");
  CHECK(poisson_text(0) == "0");
  CHECK(poisson_text(0.4999) == "0.4999");
  CHECK(poisson_text(0.49999) == "0.49999");
  CHECK(poisson_text(0.4999999999) == "0.4999999999");
  // As constants return it, with an error of rounding.
  const YoungPoisson law = young_poisson(material_from_young("mooney-rivlin", 60e3, 0.4));
  CHECK(poisson_text(law.poisson) == "0.4");
}

TEST_CASE("stiffness is told by things of that stiffness", "[material]") {
  CHECK(stiffness_text(60e3) == "6e+04 Pa, as of a very soft rubber");
  CHECK(stiffness_text(69e9) == "6.9e+10 Pa, as of glass or aluminium");
  CHECK(stiffness_text(210e9) == "2.1e+11 Pa, as of steel");
  CHECK(stiffness_text(2.1e14) == "2.1e+14 Pa, stiffer than diamond");
}

}  // namespace
}  // namespace palpable
