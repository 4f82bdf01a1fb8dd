#include "palpable/bake/separate/pod.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <Eigen/SVD>

#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::hilbert;
using test::random_case;
using test::random_weights;
using test::tolerance;

TEST_CASE("POD's error after m modes is the tail of the singular values", "[separate][pod]") {
  const SnapshotTensor tensor = hilbert(30, {6, 5});
  const VectorXd s = Eigen::JacobiSVD<MatrixXd>(tensor.values).singularValues();
  for (const int m : {1, 2, 4}) {
    const Separation result = pod(tensor, {.tolerance = 1e-12, .max_modes = m});
    REQUIRE(result.separated.F.cols() == m);
    const double direct = (expand(result.separated) - tensor.values).norm();
    CHECK(std::abs(direct - s.tail(s.size() - m).norm()) <= tolerance(1e-13, "rounding"));
    CHECK(std::abs(direct / s.norm() - result.errors[m - 1]) <= tolerance(1e-13, "rounding"));
  }
}

TEST_CASE("POD stops at the first mode that meets the tolerance", "[separate][pod]") {
  const SnapshotTensor tensor = hilbert(30, {6, 5});
  const Separation result = pod(tensor, {.tolerance = 1e-4});
  const Index m = result.errors.size();
  REQUIRE(m > 1);
  CHECK(result.reached);
  CHECK(result.errors[m - 1] <= 1e-4);
  CHECK(result.errors[m - 2] > 1e-4);
}

TEST_CASE("POD's modes are orthogonal in space and in the parameters", "[separate][pod]") {
  const Separation result = pod(hilbert(30, {6, 5}), {.tolerance = 1e-5});
  const MatrixXd FF = result.separated.F.transpose() * result.separated.F;
  const MatrixXd GG = result.separated.G[0].transpose() * result.separated.G[0];
  const Index m = FF.rows();
  CHECK((GG - MatrixXd::Identity(m, m)).norm() <= tolerance(1e-12, "rounding"));
  CHECK((FF - MatrixXd(FF.diagonal().asDiagonal())).norm() <=
        tolerance(1e-12, "rounding") * FF(0, 0));
}

TEST_CASE("a randomised POD of a tensor of low rank is exact, in one pass and in two",
          "[separate][pod]") {
  for (const int passes : {1, 2}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      INFO("passes " << passes << " seed " << seed);
      auto random = random_case(seed);
      const SnapshotTensor tensor{expand(test::random_separated(90, {40}, 4, 0.5, random)), {40}};
      const VectorXd w = random_weights(90, random);
      const RandomisedPod found = randomised_pod(
          rows_of(tensor), w, {.rank = 4, .oversampling = 4, .passes = passes, .seed = seed});
      CHECK((found.Q.transpose() * w.asDiagonal() * found.Q - MatrixXd::Identity(4, 4)).norm() <=
            tolerance(1e-12, "rounding"));
      CHECK((found.Q * found.C - tensor.values).norm() <=
            tolerance(1e-11, "rounding, times the condition of the random tests") *
                tensor.values.norm());
    }
  }
}

TEST_CASE("a randomised POD of a slowly falling tensor is near the best one", "[separate][pod]") {
  auto random = random_case(3);
  // Singular values 1, 1/2, 1/4 ...
  SeparatedTensor terms = test::random_separated(120, {60}, 25, 1.0, random);
  const MatrixXd U = Eigen::JacobiSVD<MatrixXd>(terms.F, Eigen::ComputeThinU).matrixU();
  const MatrixXd V = Eigen::JacobiSVD<MatrixXd>(terms.G[0], Eigen::ComputeThinU).matrixU();
  VectorXd s(25);
  for (Index i = 0; i < 25; ++i) s[i] = std::pow(0.5, static_cast<double>(i));
  const SnapshotTensor tensor{U * s.asDiagonal() * V.transpose(), {60}};
  const double best = s.tail(25 - 8).norm();
  const auto error = [&](int passes) {
    const RandomisedPod found = randomised_pod(rows_of(tensor), VectorXd::Ones(120),
                                               {.rank = 8, .oversampling = 8, .passes = passes});
    return (found.Q * found.C - tensor.values).norm();
  };
  // Two passes: Halko, Martinsson, Tropp 2011, theorem 10.5: (1 + k / (p - 1))^1/2 = 1.5 on
  // average, before the oversampled directions are cut off. One pass: Tropp et al. 2017,
  // theorem 4.3.
  CHECK(error(2) <= tolerance(1.5, "theorem 10.5") * best);
  CHECK(error(1) <= tolerance(3.0, "theorem 4.3, with twice the tests") * best);
  CHECK(error(2) >= best);
}

TEST_CASE("a randomised POD reads a store in blocks and once per pass", "[separate][pod]") {
  const SnapshotTensor tensor = hilbert(40, {5, 4});
  for (const int passes : {1, 2}) {
    Index read = 0;
    SnapshotRows rows = rows_of(tensor);
    const auto inner = rows.read;
    rows.read = [&](Index first, Index count) {
      read += count;
      return inner(first, count);
    };
    (void)randomised_pod(rows, VectorXd::Ones(40),
                         {.rank = 3, .oversampling = 3, .passes = passes});
    CHECK(read == 40 * passes);
  }
}

TEST_CASE("what POD cannot reduce is refused", "[separate][pod]") {
  SnapshotTensor tensor = hilbert(20, {3, 2});
  CHECK_THROWS_AS(pod({MatrixXd::Zero(20, 6), {3, 2}}, {}), Error);
  CHECK_THROWS_AS(randomised_pod(rows_of(tensor), VectorXd::Ones(20), {.passes = 3}),
                  ContractViolation);
  CHECK_THROWS_AS(randomised_pod(rows_of(tensor), VectorXd::Zero(20), {}), ContractViolation);
  tensor.values(3, 4) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(pod(tensor, {}), Error);
  CHECK_THROWS_AS(randomised_pod(rows_of(tensor), VectorXd::Ones(20), {}), Error);
}

}  // namespace

}  // namespace palpable
