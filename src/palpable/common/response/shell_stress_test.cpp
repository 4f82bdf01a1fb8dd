#include "palpable/common/response/shell_stress.h"

#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "tests/support/allocations.h"
#include "tests/support/shell_box.h"
#include "tests/support/test.h"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using test::tolerance;

constexpr int kVertices = 7;

// The lower half of a box is of one material, the upper of another.
ShellTable box(bool quadratic, const Material& low, const Material& high) {
  return test::shell_box(quadratic, kVertices, {low, high});
}

const Matrix3d kStretch =
    (Matrix3d() << 1.2, 0.1, -0.05, 0.02, 0.9, 0.08, 0.04, -0.1, 1.05).finished();

// u = (F - 1) X.
Matrix3Xf stretched(const ShellTable& shell, const Matrix3d& F) {
  return ((F - Matrix3d::Identity()) * shell.stress_free).cast<float>();
}

Matrix3d cauchy(const Material& material, const Matrix3d& F) {
  return first_piola(material, F) * F.transpose() / F.determinant();
}

double von_mises_of(const Matrix3d& sigma) {
  const Matrix3d s = sigma - sigma.trace() / 3 * Matrix3d::Identity();
  return std::sqrt(1.5 * s.squaredNorm());
}

std::vector<float> evaluated(ShellStress& stress, const Matrix3Xf& u) {
  std::vector<float> von_mises(kVertices);
  stress.evaluate(u, von_mises);
  return von_mises;
}

TEST_CASE("a uniform stretch has the law's own stress, for every law and both orders",
          "[response]") {
  for (const bool quadratic : {false, true}) {
    for (const std::string& law : law_names()) {
      INFO(law << (quadratic ? ", 10 nodes" : ", 4 nodes"));
      const Material material = material_from_young(law, 60e3, 0.4);
      const ShellTable shell = box(quadratic, material, material);
      REQUIRE(trouble_of(shell, kVertices).empty());
      ShellStress stress(shell, kVertices);
      std::vector<float> von_mises(kVertices), tensors(6 * kVertices);
      stress.evaluate(stretched(shell, kStretch), von_mises, tensors);
      const Matrix3d exact = cauchy(material, kStretch);
      const double largest = exact.cwiseAbs().maxCoeff();
      for (int v = 0; v < kVertices; ++v) {
        const float* s = tensors.data() + 6 * v;
        Matrix3d found;
        found << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
        CHECK((found - exact).cwiseAbs().maxCoeff() <
              tolerance(3e-6 * largest, "displacements and gradients in single precision"));
        CHECK(std::abs(static_cast<double>(von_mises[static_cast<std::size_t>(v)]) -
                       von_mises_of(exact)) < tolerance(5e-6 * largest, "likewise"));
      }
    }
  }
}

TEST_CASE("each element has its own material", "[response]") {
  const Material soft = material_from_young("neo-hookean", 20e3, 0.3);
  const Material hard = material_from_young("mooney-rivlin", 90e3, 0.4);
  const ShellTable shell = box(false, soft, hard);
  ShellStress stress(shell, kVertices);
  const std::vector<float> both = evaluated(stress, stretched(shell, kStretch));
  // Vertex 0 lies in the lower half alone.
  const double low = von_mises_of(cauchy(soft, kStretch));
  CHECK(std::abs(static_cast<double>(both[0]) - low) < tolerance(1e-5 * low, "single precision"));
  // A vertex between the halves has the mean of both tensors.
  int between = -1;
  for (int v = 0; v < kVertices; ++v) {
    if (shell.stress_free(2, v) == 0.02) between = v;
  }
  REQUIRE(between >= 0);
  double share = 0;  // of the soft one
  for (int k = shell.first[between]; k < shell.first[between + 1]; ++k) {
    if (shell.material_of[shell.points[k]] == 0) share += static_cast<double>(shell.weights[k]);
  }
  CHECK((share > 0.2 && share < 0.8));
  const double mixed =
      von_mises_of(share * cauchy(soft, kStretch) + (1 - share) * cauchy(hard, kStretch));
  CHECK(std::abs(static_cast<double>(both[between]) - mixed) <
        tolerance(1e-5 * mixed, "single precision"));
}

TEST_CASE("the stress includes that of a preload, and a rotation causes none", "[response]") {
  const Material material = material_from_young("neo-hookean", 60e3, 0.4);
  ShellTable shell = box(true, material, material);
  shell.preload = (kStretch - Matrix3d::Identity()) * shell.stress_free;
  ShellStress stress(shell, kVertices);
  const double exact = von_mises_of(cauchy(material, kStretch));
  const Matrix3Xf none = Matrix3Xf::Zero(3, shell.nodes());
  for (const float value : evaluated(stress, none)) {
    CHECK(std::abs(static_cast<double>(value) - exact) <
          tolerance(1e-5 * exact, "single precision"));
  }
  shell.preload.setZero();
  ShellStress free(shell, kVertices);
  for (const float value : evaluated(free, none)) CHECK(value == 0.0f);
  const Matrix3d turn =
      Eigen::AngleAxisd(1.0, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const float value : evaluated(free, stretched(shell, turn))) {
    CHECK(std::abs(value) < static_cast<float>(tolerance(0.5, "Pa, of 60,000: single precision")));
  }
}

TEST_CASE("nothing that comes out is NaN, whatever the displacement", "[response]") {
  const ShellTable shell = box(false, material_from_young("neo-hookean", 60e3, 0.4),
                               material_from_young("neo-hooke-abaqus", 60e3, 0.4));
  ShellStress stress(shell, kVertices);
  const auto check = [&](const Matrix3Xf& u) {
    std::vector<float> von_mises(kVertices), tensors(6 * kVertices);
    stress.evaluate(u, von_mises, tensors);
    for (const float value : von_mises) CHECK_FALSE(std::isnan(value));
    for (const float value : tensors) CHECK_FALSE(std::isnan(value));
    return von_mises;
  };
  check(stretched(shell, -Matrix3d::Identity()));
  check(stretched(shell, Matrix3d::Zero()));
  for (const float value : {1e-3f, 1.0f, 1e30f, std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
    Matrix3Xf u = Matrix3Xf::Zero(3, shell.nodes());
    u(2, 4) = value;
    check(u);
    u.setConstant(value);
    check(u);
  }
  // Pressed flat along z: the stress is the law's down to a hundredth of the volume, and does not
  // vanish beyond.
  const auto flat = [&](double share) {
    Matrix3d F = Matrix3d::Identity();
    F(2, 2) = share;
    return check(stretched(shell, F)).front();
  };
  CHECK(flat(0.011) > flat(0.02));
  CHECK(flat(-0.5) > 0.0f);
  CHECK(flat(0.0) > 0.0f);
  CHECK(flat(0.0) < 1e9f);  // no division by a volume of 0
}

TEST_CASE("stress allocates nothing, and the same displacement gives the same bytes",
          "[response]") {
  const ShellTable shell = box(true, material_from_young("neo-hookean", 60e3, 0.4),
                               material_from_young("mooney-rivlin", 60e3, 0.4));
  ShellStress stress(shell, kVertices), another(shell, kVertices);
  const Matrix3Xf u = stretched(shell, kStretch), v = stretched(shell, 1.1 * kStretch);
  std::vector<float> first(kVertices), second(kVertices), tensors(6 * kVertices);
  CHECK(test::allocations_during([&] { stress.evaluate(u, first, tensors); }) == 0);
  another.evaluate(v, second);
  another.evaluate(u, second);
  CHECK(first == second);
}

}  // namespace
}  // namespace palpable
