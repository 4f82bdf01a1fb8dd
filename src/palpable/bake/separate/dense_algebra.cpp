#include "palpable/bake/separate/dense_algebra.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <Eigen/QR>

#include <algorithm>
#include <cblas.h>
#include <string_view>
#include <utility>
#include <vector>

// LAPACK of the same library, for which Debian's OpenBLAS has no header. Fortran passes the length
// of each character argument after all other arguments.
extern "C" {
void dgesdd_(const char* job, const int* m, const int* n, double* a, const int* lda, double* s,
             double* u, const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork,
             int* iwork, int* info, std::size_t job_length);
void dsyevd_(const char* job, const char* triangle, const int* n, double* a, const int* lda,
             double* w, double* work, const int* lwork, int* iwork, const int* liwork, int* info,
             std::size_t job_length, std::size_t triangle_length);
}

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// OpenBLAS gets one thread: the callers divide work among threads.
[[maybe_unused]] const bool kOneThread = (openblas_set_num_threads(1), true);

int size(Index n) { return static_cast<int>(n); }

}  // namespace

void add_gram(const Eigen::Ref<const MatrixXd>& A, MatrixXd& gram) {
  PALPABLE_EXPECT(gram.rows() == A.cols() && gram.cols() == A.cols(), "a square of A's columns");
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, size(A.cols()), size(A.rows()), 1.0, A.data(),
              std::max(1, size(A.outerStride())), 1.0, gram.data(), std::max(1, size(gram.rows())));
}

MatrixXd times(const Eigen::Ref<const MatrixXd>& A, const MatrixXd& B) {
  PALPABLE_EXPECT(A.cols() == B.rows(), "sizes of a product");
  MatrixXd C = MatrixXd::Zero(A.rows(), B.cols());
  if (C.size() == 0 || A.cols() == 0) return C;
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, size(C.rows()), size(C.cols()),
              size(A.cols()), 1.0, A.data(), size(A.outerStride()), B.data(), size(B.rows()), 0.0,
              C.data(), size(C.rows()));
  return C;
}

MatrixXd transposed_times(const MatrixXd& A, const MatrixXd& B) {
  PALPABLE_EXPECT(A.rows() == B.rows(), "sizes of a product");
  MatrixXd C = MatrixXd::Zero(A.cols(), B.cols());
  if (C.size() == 0 || A.rows() == 0) return C;
  cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, size(C.rows()), size(C.cols()),
              size(A.rows()), 1.0, A.data(), size(A.rows()), B.data(), size(B.rows()), 0.0,
              C.data(), size(C.rows()));
  return C;
}

void subtract_product(const MatrixXd& A, const MatrixXd& B, MatrixXd& C) {
  PALPABLE_EXPECT(A.cols() == B.cols() && C.rows() == A.rows() && C.cols() == B.rows(),
                  "sizes of a product");
  if (C.size() == 0 || A.cols() == 0) return;
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, size(C.rows()), size(C.cols()),
              size(A.cols()), -1.0, A.data(), size(A.rows()), B.data(), size(B.rows()), 1.0,
              C.data(), size(C.rows()));
}

ThinSvd thin_svd(MatrixXd A) {
  if (!A.allFinite()) throw Error("a table holds values that are not numbers");
  const int m = size(A.rows()), n = size(A.cols()), least = std::min(m, n);
  ThinSvd svd{MatrixXd(m, least), Eigen::VectorXd(least), MatrixXd()};
  MatrixXd Vt(least, n);
  if (least == 0) return {svd.U, svd.s, Vt.transpose()};
  std::vector<int> integers(8 * static_cast<std::size_t>(least));
  int info = 0, length = -1;
  double wanted = 0;
  dgesdd_("S", &m, &n, A.data(), &m, svd.s.data(), svd.U.data(), &m, Vt.data(), &least, &wanted,
          &length, integers.data(), &info, 1);
  length = static_cast<int>(wanted);
  std::vector<double> work(length);
  dgesdd_("S", &m, &n, A.data(), &m, svd.s.data(), svd.U.data(), &m, Vt.data(), &least, work.data(),
          &length, integers.data(), &info, 1);
  if (info != 0) throw Error("the singular values of a table were not found");
  svd.V = Vt.transpose();
  return svd;
}

SymmetricEigen symmetric_eigen(MatrixXd A) {
  if (!MatrixXd(A.triangularView<Eigen::Lower>()).allFinite()) {
    throw Error("a table holds values that are not numbers");
  }
  const int n = size(A.rows());
  SymmetricEigen eigen{Eigen::VectorXd(n), std::move(A)};
  if (n == 0) return eigen;
  int info = 0, length = -1, integer_length = -1, wanted_integers = 0;
  double wanted = 0;
  dsyevd_("V", "L", &n, eigen.vectors.data(), &n, eigen.values.data(), &wanted, &length,
          &wanted_integers, &integer_length, &info, 1, 1);
  length = static_cast<int>(wanted);
  integer_length = wanted_integers;
  std::vector<double> work(length);
  std::vector<int> integers(integer_length);
  dsyevd_("V", "L", &n, eigen.vectors.data(), &n, eigen.values.data(), work.data(), &length,
          integers.data(), &integer_length, &info, 1, 1);
  if (info != 0) throw Error("the eigenvalues of a table were not found");
  return eigen;
}

MatrixXd orthonormal_basis(const MatrixXd& A) {
  PALPABLE_EXPECT(A.rows() >= A.cols(), "more rows than columns");
  return Eigen::HouseholderQR<MatrixXd>(A).householderQ() * MatrixXd::Identity(A.rows(), A.cols());
}

const char* better_blas_kernels(const char* chosen, const VectorUnits& units) {
  if (std::string_view(chosen) != "Prescott") return nullptr;
  if (units.avx512) return "SkylakeX";
  return units.avx2_and_fma ? "Haswell" : nullptr;
}

const char* better_blas_kernels() {
  VectorUnits units;
  units.avx2_and_fma = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  units.avx512 = __builtin_cpu_supports("avx512f") != 0 &&
                 __builtin_cpu_supports("avx512dq") != 0 &&
                 __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  return better_blas_kernels(openblas_get_corename(), units);
}

BlasFacts blas_facts() {
  // "OpenBLAS 0.3.21 DYNAMIC_ARCH NO_AFFINITY Haswell MAX_THREADS=64"
  const std::string config = openblas_get_config();
  const std::size_t first = config.find(' ');
  return {.name = config.substr(0, config.find(' ', first == std::string::npos ? 0 : first + 1)),
          .kernels = openblas_get_corename(),
          .thread_safe = openblas_get_parallel() != 0};
}

}  // namespace palpable
