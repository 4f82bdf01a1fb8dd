/// @file
/// Products and factorisations of dense matrices by OpenBLAS and its LAPACK. For tables of
/// snapshots they are ten times as fast as Eigen, since our programs are compiled for every x86-64
/// and Eigen chooses its vector instructions at compile time. One thread, so that the results are
/// the same to the bit on machines of the same kind.
#pragma once

#include <Eigen/Core>

#include <string>

namespace palpable {

/// gram += A^T A in the lower triangle, with the diagonal; the rest of `gram` is unchanged.
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

/// The vector instructions of a processor that OpenBLAS's kernels need.
struct VectorUnits {
  bool avx2_and_fma = false;
  bool avx512 = false;  ///< F, DQ, BW and VL
};

/// Chooses OpenBLAS's kernels for a processor. On a processor that is newer than the library,
/// OpenBLAS falls back to its kernels of 2004, which run at a quarter of the speed (seen with
/// Debian 12's 0.3.21 on Xeons from 2023).
///
/// The value to set OPENBLAS_CORETYPE to, or null if OpenBLAS's own choice is right or no better
/// one is known.
/// @param chosen  name of the kernels that OpenBLAS chose by itself
[[nodiscard]] const char* better_blas_kernels(const char* chosen, const VectorUnits& units);

/// The same for this processor and the linked OpenBLAS. OpenBLAS reads the variable before main(),
/// so the program has to set it and start itself again.
[[nodiscard]] const char* better_blas_kernels();

/// The linked BLAS.
struct BlasFacts {
  std::string name;     ///< "OpenBLAS 0.3.21"
  std::string kernels;  ///< the processor for which its kernels were written: "Haswell"
  /// It may be called by several threads at a time. Debian's serial build has no locks: when two
  /// threads call it, a product is wrong now and then.
  bool thread_safe = true;
};
[[nodiscard]] BlasFacts blas_facts();

}  // namespace palpable
