#include "palpable/bake/separate/hosvd.h"

#include "palpable/common/base/error.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::random_case;
using test::random_matrix;
using test::tolerance;

// Expands a Tucker form of three parameters term by term, independently of the code under test.
MatrixXd expand_by_hand(const Tucker& t, const std::vector<int>& n) {
  const std::vector<int> R = t.ranks();
  MatrixXd A = MatrixXd::Zero(t.U[0].rows(), n[0] * n[1] * n[2]);
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k)
        for (int a = 0; a < R[1]; ++a)
          for (int b = 0; b < R[2]; ++b)
            for (int c = 0; c < R[3]; ++c)
              A.col((i * n[1] + j) * n[2] + k) += t.U[1](i, a) * t.U[2](j, b) * t.U[3](k, c) *
                                                  (t.U[0] * t.core.col((a * R[2] + b) * R[3] + c));
  return A;
}

double error_of(const Tucker& tucker, const SnapshotTensor& tensor) {
  return (expand(tucker) - tensor.values).norm() / tensor.values.norm();
}

TEST_CASE("HOSVD's error is at most its bound, and the bound at most the tolerance",
          "[separate][hosvd]") {
  const SnapshotTensor tensor = test::hilbert(20, {7, 6, 5});
  for (const double asked : {1e-1, 1e-2, 1e-4, 1e-6}) {
    INFO("tolerance " << asked);
    const Tucker at_once = hosvd(tensor, asked, HosvdOrder::kAtOnce);
    CHECK(at_once.bound <= asked);
    CHECK(error_of(at_once, tensor) <= at_once.bound + tolerance(1e-14, "rounding"));
    CHECK(error_of(at_once, tensor) > 0.0);
    const Tucker sequential = hosvd(tensor, asked, HosvdOrder::kSequential);
    CHECK(sequential.bound <= asked);
    CHECK(std::abs(error_of(sequential, tensor) - sequential.bound) <=
          tolerance(1e-13, "rounding"));
  }
}

TEST_CASE("HOSVD finds the ranks of a tensor that has them", "[separate][hosvd]") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const std::vector<int> sizes{7, 6, 5};
    // Any core and any bases of ranks 4, 3, 2, 2.
    Tucker truth;
    truth.core = random_matrix(4, 3 * 2 * 2, random);
    truth.U = {random_matrix(25, 4, random), random_matrix(7, 3, random),
               random_matrix(6, 2, random), random_matrix(5, 2, random)};
    const SnapshotTensor tensor{expand_by_hand(truth, sizes), sizes};
    for (const HosvdOrder order : {HosvdOrder::kAtOnce, HosvdOrder::kSequential}) {
      const Tucker found = hosvd(tensor, 1e-9, order);
      CHECK(found.ranks() == std::vector<int>{4, 3, 2, 2});
      CHECK((expand_by_hand(found, sizes) - tensor.values).norm() <=
            tolerance(1e-12, "rounding") * tensor.values.norm());
    }
  }
}

TEST_CASE("HOSVD's bases are orthonormal and its two factors expand to the same tensor",
          "[separate][hosvd]") {
  const std::vector<int> sizes{7, 6, 5};
  const SnapshotTensor tensor = test::hilbert(20, sizes);
  const Tucker tucker = hosvd(tensor, 1e-3, HosvdOrder::kSequential);
  for (const MatrixXd& U : tucker.U) {
    const Index R = U.cols();
    CHECK((U.transpose() * U - MatrixXd::Identity(R, R)).norm() <= tolerance(1e-12, "rounding"));
  }
  const SeparatedTensor two = as_two_factors(tucker);
  CHECK(two.F.cols() == tucker.U[0].cols());
  CHECK((expand(two) - expand_by_hand(tucker, sizes)).norm() <=
        tolerance(1e-12, "rounding") * tensor.values.norm());
}

TEST_CASE("a tensor of zeros has no Tucker form", "[separate][hosvd]") {
  CHECK_THROWS_AS(hosvd({MatrixXd::Zero(20, 6), {3, 2}}, 1e-3, HosvdOrder::kAtOnce), Error);
}

}  // namespace
}  // namespace palpable
