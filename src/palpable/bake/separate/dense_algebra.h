/// @file
/// Products and factors of dense matrices by OpenBLAS and its LAPACK: ten times Eigen's speed for
/// tables of snapshots, since programs here are compiled for every x86-64. One thread: the same
/// bits on a machine of the same kind.
#pragma once

#include <Eigen/Core>

namespace palpable {

/// The lower triangle of gram += A^T A; what is above it stays.
void add_gram(const Eigen::Ref<const Eigen::MatrixXd>& A, Eigen::MatrixXd& gram);

/// A B
[[nodiscard]] Eigen::MatrixXd times(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                    const Eigen::MatrixXd& B);

/// A^T B
[[nodiscard]] Eigen::MatrixXd transposed_times(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// C -= A B^T
void subtract_product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::MatrixXd& C);

/// A = U diag(s) V^T, thin: n = min(rows, columns), s decreasing.
struct ThinSvd {
  Eigen::MatrixXd U;  ///< (rows x n)
  Eigen::VectorXd s;  ///< (n)
  Eigen::MatrixXd V;  ///< (columns x n)
};

/// @throws Error when A is not finite
[[nodiscard]] ThinSvd thin_svd(Eigen::MatrixXd A);

/// A = V diag(values) V^T, values increasing.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// @param A  only its lower triangle is read
/// @throws Error when A is not finite
[[nodiscard]] SymmetricEigen symmetric_eigen(Eigen::MatrixXd A);

/// (rows x n) orthonormal columns that span those of A, rows >= n: the Q of A = Q R.
[[nodiscard]] Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& A);

}  // namespace palpable
