#include "palpable/bake/separate/dense_algebra.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <limits>
#include <string>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::random_case;
using test::random_matrix;
using test::tolerance;

TEST_CASE("OpenBLAS's products are Eigen's", "[separate][dense]") {
  auto random = random_case(1);
  const MatrixXd A = random_matrix(13, 5, random), B = random_matrix(5, 7, random);
  const MatrixXd D = random_matrix(13, 4, random), E = random_matrix(7, 5, random);
  CHECK((times(A, B) - A * B).norm() <= tolerance(1e-13, "rounding"));
  CHECK((transposed_times(A, D) - A.transpose() * D).norm() <= tolerance(1e-13, "rounding"));
  MatrixXd C = random_matrix(13, 7, random);
  const MatrixXd expected = C - A * E.transpose();
  subtract_product(A, E, C);
  CHECK((C - expected).norm() <= tolerance(1e-13, "rounding"));
  MatrixXd gram = MatrixXd::Ones(5, 5);
  add_gram(A, gram);
  const MatrixXd whole = MatrixXd::Ones(5, 5) + A.transpose() * A;
  for (Index j = 0; j < 5; ++j) {
    for (Index i = 0; i < 5; ++i) {
      CHECK(std::abs(gram(i, j) - (i >= j ? whole(i, j) : 1.0)) <= tolerance(1e-13, "rounding"));
    }
  }
  CHECK_THROWS_AS(times(A, D), ContractViolation);
}

TEST_CASE("the product of LAPACK's factors is the matrix that was factorised",
          "[separate][dense]") {
  auto random = random_case(2);
  for (const auto& [rows, columns] : {std::pair{9, 4}, {4, 9}, {5, 5}, {1, 3}}) {
    const MatrixXd A = random_matrix(rows, columns, random);
    const Index n = std::min(rows, columns);
    const ThinSvd svd = thin_svd(A);
    CHECK((svd.U * svd.s.asDiagonal() * svd.V.transpose() - A).norm() <=
          tolerance(1e-13, "rounding"));
    CHECK((svd.V.transpose() * svd.V - MatrixXd::Identity(n, n)).norm() <=
          tolerance(1e-13, "rounding"));
    for (Index i = 1; i < n; ++i) CHECK(svd.s[i] <= svd.s[i - 1]);
  }
  const MatrixXd half = random_matrix(6, 6, random);
  const MatrixXd A = half + half.transpose();
  const SymmetricEigen eigen = symmetric_eigen(A.triangularView<Eigen::Lower>());
  CHECK((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose() - A).norm() <=
        tolerance(1e-12, "rounding"));
  for (Index i = 1; i < 6; ++i) CHECK(eigen.values[i] >= eigen.values[i - 1]);
  const MatrixXd tall = random_matrix(11, 3, random), Q = orthonormal_basis(tall);
  CHECK((Q.transpose() * Q - MatrixXd::Identity(3, 3)).norm() <= tolerance(1e-13, "rounding"));
  CHECK((Q * (Q.transpose() * tall) - tall).norm() <= tolerance(1e-13, "rounding"));
  MatrixXd bad = A;
  bad(2, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(thin_svd(bad), Error);
  CHECK_THROWS_AS(symmetric_eigen(bad), Error);
}

TEST_CASE("other kernels are asked for only where OpenBLAS took its oldest", "[separate][blas]") {
  CHECK(better_blas_kernels("Zen", {true, true}) == nullptr);
  CHECK(better_blas_kernels("Haswell", {true, true}) == nullptr);
  CHECK(better_blas_kernels("Prescott", {false, false}) == nullptr);
  CHECK(better_blas_kernels("Prescott", {true, false}) == std::string("Haswell"));
  CHECK(better_blas_kernels("Prescott", {true, true}) == std::string("SkylakeX"));
}

}  // namespace

}  // namespace palpable
