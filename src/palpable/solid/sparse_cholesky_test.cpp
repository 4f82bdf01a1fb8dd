#include "palpable/solid/sparse_cholesky.h"

#include "palpable/solid/conjugate_gradients.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

// A chain of nodes, each tied to the two next.
BlockPattern chain(int M) {
  BlockPattern pattern;
  pattern.row_start.push_back(0);
  for (int r = 0; r < M; ++r) {
    for (int c = std::max(0, r - 2); c <= std::min(M - 1, r + 2); ++c) pattern.column.push_back(c);
    pattern.row_start.push_back(static_cast<int>(pattern.column.size()));
  }
  return pattern;
}

// Symmetric; positive definite if `diagonal` outweighs the 4 x 9 random numbers of a row.
BlockMatrix some_matrix(const BlockPattern& pattern, double diagonal, unsigned seed) {
  auto random = test::random_case(seed);
  std::uniform_real_distribution<double> entry(-1, 1);
  BlockMatrix K(pattern);
  for (int r = 0; r < pattern.rows(); ++r) {
    for (int c = 0; c <= r; ++c) {
      const int place = pattern.find(r, c);
      if (place < 0) continue;
      const Matrix3d B = Matrix3d::NullaryExpr([&] { return entry(random); });
      if (c == r) {
        K.block(place) = B + B.transpose() + diagonal * Matrix3d::Identity();
      } else {
        K.block(place) = B;
        K.block(pattern.find(c, r)) = B.transpose();
      }
    }
  }
  return K;
}

MatrixXd dense(const BlockMatrix& K) {
  const BlockPattern& pattern = K.pattern();
  MatrixXd A = MatrixXd::Zero(3 * pattern.rows(), 3 * pattern.rows());
  for (int r = 0; r < pattern.rows(); ++r) {
    for (int c = 0; c < pattern.rows(); ++c) {
      const int place = pattern.find(r, c);
      if (place >= 0) A.block<3, 3>(3 * r, 3 * c) = K.block(place);
    }
  }
  return A;
}

TEST_CASE("a block matrix multiplies as its dense form", "[solid][sparse]") {
  const BlockPattern pattern = chain(9);
  const BlockMatrix K = some_matrix(pattern, 3, 1);
  const VectorXd x = VectorXd::LinSpaced(27, -1, 2);
  VectorXd y;
  K.multiply(x, y);
  CHECK((y - dense(K) * x).norm() <= tolerance(1e-13, "sums of 15 numbers of order 1"));
  CHECK(pattern.find(0, 5) == -1);
}

TEST_CASE("the sparse factor solves what the dense one solves", "[solid][sparse]") {
  const BlockPattern pattern = chain(40);
  const BlockMatrix K = some_matrix(pattern, 20, 2);
  FactorWorkspace workspace;
  const CholeskyAnalysis analysis(pattern, workspace);
  CHECK(analysis.nonzeros() >= 120 * 121 / 2 * 0.05);
  const auto factor = CholeskyFactor::make(analysis, K, workspace);
  REQUIRE(factor);
  const VectorXd b = VectorXd::LinSpaced(120, -1, 2);
  VectorXd x;
  factor->solve(b, x, workspace);
  const VectorXd expected = dense(K).llt().solve(b);
  CHECK((x - expected).norm() <= tolerance(1e-13, "condition of order 10") * expected.norm());
}

TEST_CASE("a matrix that is not positive definite has no factor", "[solid][sparse]") {
  const BlockPattern pattern = chain(12);
  FactorWorkspace workspace;
  const CholeskyAnalysis analysis(pattern, workspace);
  CHECK_FALSE(CholeskyFactor::make(analysis, some_matrix(pattern, 0, 3), workspace));
  CHECK(CholeskyFactor::make(analysis, some_matrix(pattern, 20, 3), workspace));  // and goes on
}

TEST_CASE("conjugate gradients with an older factor reach the tolerance asked for",
          "[solid][sparse]") {
  const BlockPattern pattern = chain(40);
  const BlockMatrix older = some_matrix(pattern, 20, 2), K = some_matrix(pattern, 16, 4);
  FactorWorkspace workspace;
  const CholeskyAnalysis analysis(pattern, workspace);
  const auto factor = CholeskyFactor::make(analysis, older, workspace);
  REQUIRE(factor);
  const VectorXd b = VectorXd::LinSpaced(120, -1, 2);
  VectorXd x;
  CgScratch scratch;
  int before = 0;
  for (const double goal : {1e-2, 1e-6, 1e-10}) {
    const CgResult result = conjugate_gradients(K, *factor, b, goal, 200, x, scratch, workspace);
    CHECK(result.end == CgEnd::kConverged);
    CHECK(result.iterations > before);
    before = result.iterations;
    CHECK((dense(K) * x - b).norm() <= 1.0001 * goal * b.norm());
  }
  CHECK(conjugate_gradients(K, *factor, b, 1e-10, 2, x, scratch, workspace).end ==
        CgEnd::kTooManyIterations);
}

TEST_CASE("conjugate gradients end within as many steps as eigenvalues differ from the factor's",
          "[solid][sparse]") {
  // K differs from the factorised matrix in one block alone: K = older + a rank of 3.
  const BlockPattern pattern = chain(40);
  const BlockMatrix older = some_matrix(pattern, 20, 2);
  BlockMatrix K = older;
  K.block(pattern.find(7, 7)) += Eigen::Vector3d(10, 20, 40).asDiagonal();
  FactorWorkspace workspace;
  const CholeskyAnalysis analysis(pattern, workspace);
  const auto factor = CholeskyFactor::make(analysis, older, workspace);
  REQUIRE(factor);
  const VectorXd b = VectorXd::LinSpaced(120, -1, 2);
  VectorXd x;
  CgScratch scratch;
  // As far as the preconditioner's single precision lets the eigenvalues be equal.
  CHECK(conjugate_gradients(older, *factor, b, 1e-5, 50, x, scratch, workspace).iterations == 1);
  CHECK(conjugate_gradients(K, *factor, b, 1e-5, 50, x, scratch, workspace).iterations <= 4);
}

TEST_CASE("the rough solve agrees with the dense one to single precision", "[solid][sparse]") {
  for (const double scale : {1e-30, 1.0, 1e30}) {  // loads beyond the range of single precision too
    INFO("scale " << scale);
    const BlockPattern pattern = chain(40);
    const BlockMatrix K = some_matrix(pattern, 20, 2);
    FactorWorkspace workspace;
    const CholeskyAnalysis analysis(pattern, workspace);
    const auto factor = CholeskyFactor::make(analysis, K, workspace);
    REQUIRE(factor);
    const VectorXd b = scale * VectorXd::LinSpaced(120, -1, 2);
    const VectorXd truth = dense(K).llt().solve(b);
    VectorXd x;
    factor->solve_roughly(b, x, workspace);
    CHECK((x - truth).norm() <=
          tolerance(1e-6, "single precision, a condition of about 2") * truth.norm());
    factor->solve_roughly(0.0 * b, x, workspace);
    CHECK(x == VectorXd::Zero(120));
  }
}

TEST_CASE("conjugate gradients notice a matrix that is not positive definite", "[solid][sparse]") {
  const BlockPattern pattern = chain(40);
  const BlockMatrix older = some_matrix(pattern, 20, 2), K = some_matrix(pattern, -1, 4);
  FactorWorkspace workspace;
  const CholeskyAnalysis analysis(pattern, workspace);
  const auto factor = CholeskyFactor::make(analysis, older, workspace);
  REQUIRE(factor);
  VectorXd x;
  CgScratch scratch;
  const CgResult result = conjugate_gradients(K, *factor, VectorXd::LinSpaced(120, -1, 2), 1e-8,
                                              200, x, scratch, workspace);
  CHECK(result.end == CgEnd::kNegativeCurvature);
}

}  // namespace
}  // namespace palpable
