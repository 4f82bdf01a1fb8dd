#include "palpable/bake/solid/modal_forms.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/load_response.h"
#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <string>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

constexpr FormSampling kAll{.exact = 1, .neglect = 0};

// 40 x 30 x 20 mm of rubber, held below; half of it of another law.
SolidModel block(const std::string& law) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.04, 0.03, 0.02}, 3, 2, 2);
  model.material = material_from_young(law, 60e3, 0.4);
  MaterialGroup stiff{material_from_young("neo-hookean", 90e3, 0.3), {}};
  for (int e = 0; e < model.mesh.tet_count(); e += 2) stiff.elements.push_back(e);
  model.groups.push_back(stiff);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
  }
  return model;
}

MatrixXd some_modes(const SolidModel& model, int count) {
  auto random = test::random_case(4);
  std::normal_distribution<double> entry(0.0, 1e-3);
  MatrixXd modes = MatrixXd::NullaryExpr(3 * Index{model.mesh.node_count()}, count,
                                         [&] { return entry(random); });
  for (const int n : model.fixed_nodes) modes.middleRows(3 * Index{n}, 3).setZero();
  return modes;
}

// Index of i <= j <= k (<= l) among the distinct coefficients, by counting.
std::size_t index_of(int n, std::vector<int> wanted) {
  std::sort(wanted.begin(), wanted.end());
  std::size_t number = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      for (int k = j; k < n; ++k) {
        if (wanted.size() == 3) {
          if (wanted == std::vector{i, j, k}) return number;
          ++number;
          continue;
        }
        for (int l = k; l < n; ++l, ++number) {
          if (wanted == std::vector{i, j, k, l}) return number;
        }
      }
    }
  }
  FAIL("no such coefficient");
  return 0;
}

// Compares the forms with derivatives of the forces on the full mesh.
void check_forms(const SolidModel& model, const Preloaded* preloaded) {
  const LoadResponse response(model, preloaded);
  const MatrixXd U = some_modes(model, 4);
  const int s = 3;
  const ModalForms forms = ModalFormMaker(model, response.rest()).make(U, s, kAll);
  REQUIRE(forms.cubic.size() == 20);
  REQUIRE(forms.quartic.size() == 15);
  const auto A = [&](int i, int j, int k) { return forms.cubic[index_of(4, {i, j, k})]; };
  double largest = 0;
  for (const double a : forms.cubic) largest = std::max(largest, std::abs(a));
  for (const auto& [i, j, k] : {std::array{0, 0, 0}, {0, 1, 2}, {3, 1, 3}, {2, 3, 0}}) {
    const double expected = response.mixed_force(U.col(i), U.col(j)).dot(U.col(k));
    CHECK(A(i, j, k) == Approx(expected).margin(tolerance(2e-6, "single precision") * largest));
  }
  // E(a, a, a, w) = 6 third_force(a, 0) . w - 3 sum_m A(a, a, m) A(a, w, m)
  const Eigen::Vector3d a(0.7, -1.1, 0.4), w(0.3, 0.5, -0.8);
  const VectorXd u = U.leftCols(3) * a, v = U.leftCols(3) * w;
  double expected = 6 * response.third_force(u, VectorXd::Zero(u.size())).dot(v), size = 0;
  for (int m = 0; m < s; ++m) {
    const VectorXd with_m = response.mixed_force(u, U.col(m));
    expected -= 3 * with_m.dot(u) * with_m.dot(v);
  }
  double sum = 0;
  for (int i = 0; i < s; ++i) {
    for (int j = 0; j < s; ++j) {
      for (int k = 0; k < s; ++k) {
        for (int l = 0; l < s; ++l) {
          const double term = forms.quartic[index_of(s, {i, j, k, l})] * a[i] * a[j] * a[k] * w[l];
          sum += term;
          size += std::abs(term);
        }
      }
    }
  }
  CHECK(sum == Approx(expected).margin(tolerance(2e-6, "single precision") * size));
}

TEST_CASE("the forms of a body's energy are what its forces say, for every law", "[solid][forms]") {
  for (const std::string& law : law_names()) {
    SolidModel model = block(law);
    DYNAMIC_SECTION(law << " at rest") { check_forms(model, nullptr); }
    DYNAMIC_SECTION(law << " with 10-node tetrahedra") {
      model.mesh = with_edge_nodes(model.mesh);
      model.fixed_nodes.clear();
      for (int n = 0; n < model.mesh.node_count(); ++n) {
        if (model.mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
      }
      check_forms(model, nullptr);
    }
    DYNAMIC_SECTION(law << " where something acts already") {
      Matrix3Xd f = Matrix3Xd::Zero(3, model.mesh.node_count());
      for (int n = 0; n < model.mesh.node_count(); ++n) {
        if (model.mesh.nodes(2, n) > 0.019) f(0, n) = 0.3;
      }
      const EquilibriumSolver solver(model);
      const std::array level{1.0};
      const PathResult path = solver.solve_path(f, level);
      REQUIRE(path.complete);
      const Preloaded preloaded{f, path.steps[0].displacement};
      CHECK(preloaded.rest.cwiseAbs().maxCoeff() > 0.0005);
      check_forms(model, &preloaded);
    }
  }
}

TEST_CASE("points that carry little are sampled, and the forms change by little",
          "[solid][forms]") {
  SolidModel model = block("neo-hookean");
  model.groups.clear();
  model.mesh = box_tets({0, 0, 0}, {0.04, 0.03, 0.02}, 16, 12, 8);
  model.fixed_nodes.clear();
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) < 0.001) model.fixed_nodes.push_back(n);
  }
  // The responses to loads on its top: steep under them, flat elsewhere.
  const LoadResponse response(model);
  MatrixXd f = MatrixXd::Zero(3 * Index{model.mesh.node_count()}, 2);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    const Eigen::Vector3d X = model.mesh.nodes.col(n);
    if (X.z() < 0.019 || (X.head<2>() - Eigen::Vector2d(0.02, 0.015)).norm() > 0.004) continue;
    f(3 * Index{n} + 2, 0) = -0.05;
    f(3 * Index{n}, 1) = 0.02;
  }
  const MatrixXd U = response.linear(f);
  const ModalFormMaker maker(model, response.rest());
  const ModalForms all = maker.make(U, 2, kAll), some = maker.make(U, 2);
  double largest = 0;
  for (const double a : all.cubic) largest = std::max(largest, std::abs(a));
  for (std::size_t k = 0; k < all.cubic.size(); ++k) {
    CHECK(some.cubic[k] ==
          Approx(all.cubic[k]).margin(tolerance(0.02, "a tenth is sampled") * largest));
    CHECK(some.cubic[k] != all.cubic[k]);
  }
  double most = 0;
  for (const double e : all.quartic) most = std::max(most, std::abs(e));
  for (std::size_t k = 0; k < all.quartic.size(); ++k) {
    CHECK(some.quartic[k] ==
          Approx(all.quartic[k]).margin(tolerance(0.02, "a tenth is sampled") * most));
  }
}

TEST_CASE("no leading modes have no quartic form, and more than there are are refused",
          "[solid][forms]") {
  const SolidModel model = block("neo-hookean");
  const ModalFormMaker maker(model, Matrix3Xd::Zero(3, model.mesh.node_count()));
  const MatrixXd U = some_modes(model, 1);
  CHECK(maker.make(MatrixXd::Zero(U.rows(), 2), 0).quartic.empty());
  CHECK_THROWS_AS(maker.make(U, 2), ContractViolation);
}

}  // namespace
}  // namespace palpable
