#include "palpable/bake/separate/sparse_pgd.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::random_case;
using test::tolerance;

MatrixXd uniform_points(Index p, Index T, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  MatrixXd points(p, T);
  for (double& x : points.reshaped()) x = uniform(random);
  return points;
}

double error_at(const SparsePgd& model, const MatrixXd& values, const MatrixXd& points) {
  double lost = 0;
  for (Index t = 0; t < points.cols(); ++t) {
    lost += (values.col(t) - model.F * model.functions(points.col(t))).squaredNorm();
  }
  return std::sqrt(lost / values.squaredNorm());
}

TEST_CASE("the polynomials of sparse PGD are Legendre's", "[separate][sparse]") {
  const SparseAxis axis{.name = "x", .low = 2.0, .high = 6.0, .highest_degree = 3};
  const VectorXd phi = basis_functions(axis, 5.0);  // x = 1/2
  REQUIRE(phi.size() == 4);
  const double expected[] = {1.0, 0.5, (3 * 0.25 - 1) / 2, (5 * 0.125 - 3 * 0.5) / 2};
  for (Index n = 0; n < 4; ++n) {
    CHECK(std::abs(phi[n] - expected[n]) <= tolerance(1e-15, "rounding"));
  }
  SparseAxis held = axis;
  held.zero_at_low = true;
  CHECK(basis_functions(held, 2.0).isZero(0.0));
  CHECK((basis_functions(held, 5.0) - 0.75 * phi).norm() <= tolerance(1e-15, "rounding"));
}

TEST_CASE("sparse PGD finds separated polynomials between a few scattered samples",
          "[separate][sparse]") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const MatrixXd F = test::random_matrix(12, 2, random);
    const auto field = [&](const MatrixXd& points) {
      MatrixXd values(12, points.cols());
      for (Index t = 0; t < points.cols(); ++t) {
        const double x = points(0, t), y = points(1, t);
        values.col(t) = F.col(0) * (1 + x + x * x * x) * (2 - y) +
                        0.2 * F.col(1) * std::pow(x - 0.3, 2.0) * y * y;
      }
      return values;
    };
    const MatrixXd points = uniform_points(2, 60, random), others = uniform_points(2, 200, random);
    const SparsePgd model =
        sparse_pgd(field(points), points,
                   {{.name = "x", .highest_degree = 6}, {.name = "y", .highest_degree = 6}});
    CHECK(error_at(model, field(others), others) <=
          tolerance(1e-4, "the ridge, 1e-8, on nearly parallel modes"));
    CHECK(model.F.cols() <= 8);
  }
}

TEST_CASE("choices have values of their own in sparse PGD", "[separate][sparse]") {
  auto random = random_case(7);
  const MatrixXd F = test::random_matrix(10, 1, random);
  const double own[] = {1.0, -2.0, 0.5, 4.0};
  MatrixXd points = uniform_points(2, 60, random);
  for (Index t = 0; t < 60; ++t) points(1, t) = static_cast<double>(t % 4);
  MatrixXd values(10, 60);
  for (Index t = 0; t < 60; ++t) {
    values.col(t) = F.col(0) * points(0, t) * own[static_cast<int>(points(1, t))];
  }
  const SparsePgd model =
      sparse_pgd(values, points,
                 {{.name = "level", .zero_at_low = true, .highest_degree = 4},
                  {.name = "site", .basis = SparseAxis::Basis::kNodal, .choices = 4}});
  CHECK(model.training_errors[0] <= tolerance(1e-6, "the ridge"));
  VectorXd mu(2);
  mu << 0.37, 3.0;
  CHECK((model.F * model.functions(mu) - F.col(0) * 0.37 * 4.0).norm() <=
        tolerance(1e-6, "the ridge") * F.norm());
  mu << 0.0, 1.0;
  CHECK(model.functions(mu).isZero(0.0));
}

TEST_CASE("a choice is left out only if another sample of it is in the training samples",
          "[separate][sparse]") {
  // Twelve choices with two samples each; both samples of some choices fall into the same fold.
  auto random = random_case(4);
  const MatrixXd F = test::random_matrix(6, 1, random);
  MatrixXd points(2, 24), values(6, 24);
  for (Index t = 0; t < 24; ++t) {
    points.col(t) << 0.25 + 0.5 * static_cast<double>(t % 2), static_cast<double>(t / 2);
    values.col(t) = F.col(0) * points(0, t) * (1.0 + points(1, t));
  }
  const std::vector<SparseAxis> axes{
      {.name = "level", .zero_at_low = true, .highest_degree = 2},
      {.name = "site", .basis = SparseAxis::Basis::kNodal, .choices = 12}};
  CHECK(sparse_pgd(values, points, axes).validation_errors[0] <=
        tolerance(1e-2, "alternation stops early"));
  // With one sample of each choice none can be predicted.
  const std::vector<Index> even{0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22};
  CHECK_THROWS_AS(sparse_pgd(values(Eigen::all, even), points(Eigen::all, even), axes), Error);
}

TEST_CASE("noise in samples is not learnt by raising degrees", "[separate][sparse]") {
  auto random = random_case(5);
  std::normal_distribution<double> normal(0.0, 0.05);
  const auto truth = [](double x) { return 1.0 + 2.0 * x; };
  const MatrixXd points = uniform_points(1, 40, random), others = uniform_points(1, 300, random);
  MatrixXd values(1, 40), clean(1, 300);
  for (Index t = 0; t < 40; ++t) values(0, t) = truth(points(0, t)) + normal(random);
  for (Index t = 0; t < 300; ++t) clean(0, t) = truth(others(0, t));
  const SparsePgd model =
      sparse_pgd(values, points, {{.name = "x", .highest_degree = 20}}, {.max_modes = 6});
  CHECK(model.degrees.back()[0] <= 3);
  CHECK(error_at(model, clean, others) <= tolerance(0.02, "noise of 2.5 %, averaged"));
}

TEST_CASE("sparse PGD is the same every time", "[separate][sparse]") {
  auto random = random_case(2);
  const MatrixXd points = uniform_points(2, 30, random);
  const MatrixXd values = test::random_matrix(6, 30, random);
  const std::vector<SparseAxis> axes{{.name = "x"}, {.name = "y"}};
  CHECK(sparse_pgd(values, points, axes).F == sparse_pgd(values, points, axes).F);
}

TEST_CASE("what sparse PGD cannot learn from is refused", "[separate][sparse]") {
  auto random = random_case(3);
  const MatrixXd points = uniform_points(1, 20, random);
  MatrixXd values = test::random_matrix(4, 20, random);
  CHECK_THROWS_AS(sparse_pgd(MatrixXd::Zero(4, 20), points, {{.name = "x"}}), Error);
  CHECK_THROWS_AS(sparse_pgd(values, points, {{.name = "x"}, {.name = "y"}}), ContractViolation);
  CHECK_THROWS_AS(sparse_pgd(values, points,
                             {{.name = "site", .basis = SparseAxis::Basis::kNodal, .choices = 2}}),
                  ContractViolation);
  values(1, 2) = std::nan("");
  CHECK_THROWS_AS(sparse_pgd(values, points, {{.name = "x"}}), Error);
}

}  // namespace
}  // namespace palpable
