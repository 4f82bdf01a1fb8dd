#include "palpable/common/response/modal_stress.h"

#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/common/material/material.h"
#include "palpable/common/response/shell_stress.h"
#include "tests/support/allocations.h"
#include "tests/support/shell_box.h"
#include "tests/support/test.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXf;
using test::tolerance;

constexpr int kVertices = 11;  // the first nodes are the skin's; not a multiple of eight

ShellTable box(bool quadratic, const Material& material) {
  return test::shell_box(quadratic, kVertices, {material});
}

const Matrix3d kStretch =
    (Matrix3d() << 1.2, 0.1, -0.05, 0.02, 0.9, 0.08, 0.04, -0.1, 1.05).finished();

// Mode i + 3 J has the gradient e_i e_J^T everywhere: nine of them, an odd number.
MatrixXf uniform_modes(const ShellTable& shell) {
  MatrixXf modes = MatrixXf::Zero(3 * shell.nodes(), 9);
  for (Index n = 0; n < shell.nodes(); ++n) {
    for (Index J = 0; J < 3; ++J) {
      for (Index i = 0; i < 3; ++i) {
        modes(3 * n + i, i + 3 * J) = static_cast<float>(shell.stress_free(J, n));
      }
    }
  }
  return modes;
}

// Four modes that are quadratic in the position.
MatrixXf bent_modes(const ShellTable& shell) {
  MatrixXf modes(3 * shell.nodes(), 4);
  auto random = test::random_case(3);
  std::uniform_real_distribution<double> number(-20, 20);
  for (Index i = 0; i < 4; ++i) {
    std::array<Matrix3d, 3> H;
    for (Matrix3d& h : H) h = Matrix3d::NullaryExpr([&] { return number(random); });
    for (Index n = 0; n < shell.nodes(); ++n) {
      const Eigen::Vector3d X = shell.stress_free.col(n);
      for (Index c = 0; c < 3; ++c) {
        modes(3 * n + c, i) = static_cast<float>(X.dot(H[static_cast<std::size_t>(c)] * X));
      }
    }
  }
  return modes;
}

ModalStress stress_of(const ShellTable& shell, const MatrixXf& modes, const LoadStates& loads = {},
                      SimdLevel level = best_simd_level()) {
  return {shell, modes.topRows(3 * kVertices), modes.bottomRows(modes.rows() - 3 * kVertices),
          loads, level};
}

std::vector<float> amplitudes(const Matrix3d& F) {
  const Matrix3d G = F - Matrix3d::Identity();
  return {G.data(), G.data() + 9};
}

std::vector<float> evaluated(ModalStress& stress, const std::vector<float>& q) {
  std::vector<float> von_mises(kVertices);
  stress.evaluate(q, von_mises);
  return von_mises;
}

double von_mises_of(const Matrix3d& sigma) {
  const Matrix3d s = sigma - sigma.trace() / 3 * Matrix3d::Identity();
  return std::sqrt(1.5 * s.squaredNorm());
}

TEST_CASE("in modes a uniform stretch has the law's own stress, for every law and both orders",
          "[response]") {
  for (const bool quadratic : {false, true}) {
    for (const std::string& law : law_names()) {
      INFO(law << (quadratic ? ", 10 nodes" : ", 4 nodes"));
      const Material material = material_from_young(law, 60e3, 0.4);
      const ShellTable shell = box(quadratic, material);
      REQUIRE(ModalStress::serves(shell));
      ModalStress stress = stress_of(shell, uniform_modes(shell));
      std::vector<float> von_mises(kVertices), tensors(6 * kVertices);
      stress.evaluate(amplitudes(kStretch), von_mises, tensors);
      const Matrix3d exact =
          first_piola(material, kStretch) * kStretch.transpose() / kStretch.determinant();
      const double largest = exact.cwiseAbs().maxCoeff();
      for (int v = 0; v < kVertices; ++v) {
        const float* s = tensors.data() + 6 * v;
        Matrix3d found;
        found << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
        CHECK((found - exact).cwiseAbs().maxCoeff() <
              tolerance(1e-4 * largest, "gradients in 16 bits"));
        CHECK(std::abs(static_cast<double>(von_mises[static_cast<std::size_t>(v)]) -
                       von_mises_of(exact)) < tolerance(1e-4 * largest, "likewise"));
      }
    }
  }
}

// Largest difference of the stress in modes from ShellStress for a body bent by q, as a ratio to
// the largest stress.
float difference(const ShellTable& shell, const MatrixXf& modes, const LoadStates& loads,
                 const Eigen::VectorXf& q) {
  ModalStress stress = stress_of(shell, modes, loads);
  ShellStress whole(shell, kVertices);
  std::vector<float> tensors(6 * kVertices), exact(6 * kVertices), none(kVertices);
  stress.evaluate({q.data(), static_cast<std::size_t>(q.size())}, none, tensors);
  const Eigen::VectorXf u = modes * q;
  whole.evaluate(u.reshaped(3, shell.nodes()), none, exact);
  float largest = 0, off = 0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    largest = std::max(largest, std::abs(exact[k]));
    off = std::max(off, std::abs(tensors[k] - exact[k]));
  }
  return off / largest;
}

TEST_CASE("the law in the recovered gradient differs from the recovered law by squares alone",
          "[response]") {
  const ShellTable shell = box(false, material_from_young("saint-venant-kirchhoff", 60e3, 0.4));
  const MatrixXf modes = bent_modes(shell);
  const Eigen::VectorXf q = Eigen::Vector4f(0.5f, -1, 0.7f, 0.9f);
  const float small = difference(shell, modes, {}, 0.02f * q),
              large = difference(shell, modes, {}, 0.08f * q);
  INFO(small << " and " << large << " of the largest stress");
  CHECK(small > 0.005f);
  CHECK(large > 3 * small);
  CHECK(large < 5 * small);
}

TEST_CASE("squares of load states are in the stress in modes", "[response]") {
  const ShellTable shell = box(false, material_from_young("saint-venant-kirchhoff", 60e3, 0.4));
  const MatrixXf modes = bent_modes(shell);
  // States that are not modes, and amplitudes in the span of two of them.
  LoadStates loads;
  loads.states.resize(4, 3);
  loads.states << 0.5f, 0.3f, 0.1f, -1, 0.4f, -0.2f, 0.7f, -0.1f, 0.8f, 0.9f, 0.6f, 0.2f;
  loads.duals = loads.states.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::VectorXf q = 0.02f * (loads.states.col(0) - 0.6f * loads.states.col(1));
  const float off = difference(shell, modes, {}, q), left = difference(shell, modes, loads, q);
  INFO(off << " of the largest stress without squares, " << left << " with them");
  CHECK(off > 0.005f);
  CHECK(left < 0.1f * off);
  CHECK(left < static_cast<float>(tolerance(2e-3, "cubes, and 16 bits")));
}

TEST_CASE("stress in modes is never NaN, allocates nothing, and has the same bytes everywhere",
          "[response]") {
  const ShellTable shell = box(false, material_from_young("neo-hooke-abaqus", 60e3, 0.4));
  const MatrixXf modes = uniform_modes(shell);
  const LoadStates loads{MatrixXf::Identity(9, 2), MatrixXf::Identity(2, 9)};
  ModalStress stress = stress_of(shell, modes, loads),
              plain = stress_of(shell, modes, loads, SimdLevel::kPlain);
  std::vector<float> q = amplitudes(kStretch), here(kVertices);
  CHECK(test::allocations_during([&] { stress.evaluate(q, here); }) == 0);
  CHECK(here == evaluated(plain, q));
  for (const float value : evaluated(stress, std::vector<float>(9, 0.0f))) CHECK(value == 0.0f);
  for (const float value : {-1.0f, 1e30f, std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
    q[4] = value;
    for (const float found : evaluated(stress, q)) CHECK_FALSE(std::isnan(found));
  }
}

TEST_CASE(
    "the stress of a shell with several materials, with a preload, or whose recovery changes a "
    "constant is not evaluated in modes",
    "[response]") {
  const Material material = material_from_young("neo-hookean", 60e3, 0.4);
  ShellTable shell = box(false, material);
  shell.materials.push_back(material);
  CHECK_FALSE(ModalStress::serves(shell));
  shell.materials.pop_back();
  CHECK(ModalStress::serves(shell));
  shell.preload(1, 5) = 1e-3;
  CHECK_FALSE(ModalStress::serves(shell));
  shell.preload.setZero();
  shell.weights.front() += 0.01f;
  CHECK_FALSE(ModalStress::serves(shell));
}

}  // namespace
}  // namespace palpable
