#include "palpable/bake/separate/greedy_pgd.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <Eigen/SVD>

#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::dents;
using test::random_case;
using test::random_separated;
using test::tolerance;

TEST_CASE("a tensor that is one separated term is found with one mode", "[separate][Sec3.2]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const std::vector<int> sizes{4, 3, 2};
    const SnapshotTensor snapshots{expand(random_separated(30, sizes, 1, 1.0, random)), sizes};
    const Separation result = greedy_pgd(snapshots, {.tolerance = 1e-9});
    CHECK(result.separated.F.cols() == 1);
    CHECK((expand(result.separated) - snapshots.values).norm() <=
          tolerance(1e-12, "rounding") * snapshots.values.norm());
  }
}

TEST_CASE("a tensor of known rank is recovered, with two, three and four factors",
          "[separate][Sec3.2]") {
  for (const std::vector<int>& sizes : {std::vector<int>{11}, {7, 5}, {5, 4, 3}}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      INFO("p " << sizes.size() << " seed " << seed);
      auto random = random_case(seed);
      const SnapshotTensor snapshots{expand(random_separated(60, sizes, 3, 0.3, random)), sizes};
      const Separation result = greedy_pgd(snapshots, {.tolerance = 1e-4, .max_modes = 12});
      CHECK(result.reached);
      CHECK(result.separated.G.size() == sizes.size());
      CHECK((expand(result.separated) - snapshots.values).norm() <= 1e-4 * snapshots.values.norm());
    }
  }
}

TEST_CASE("with one parameter the greedy modes are those of the singular value decomposition",
          "[separate][Sec3.2]") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    // Separated singular values, so that alternating directions (a power iteration) converge.
    const MatrixXd A = expand(random_separated(40, {9}, 5, 0.2, random));
    const Eigen::VectorXd s = Eigen::JacobiSVD<MatrixXd>(A).singularValues();
    const Separation result =
        greedy_pgd({A, {9}}, {.tolerance = 1e-6, .max_modes = 4}, {.pass_tolerance = 1e-9});
    for (Index m = 1; m <= result.errors.size(); ++m) {
      const double best = s.tail(s.size() - m).norm() / s.norm();  // Eckart and Young
      CHECK(result.errors[m - 1] >= best - tolerance(1e-9, "rounding"));
      CHECK(result.errors[m - 1] <= best * (1 + tolerance(1e-3, "power iterations stop early")));
    }
  }
}

TEST_CASE("each further mode lowers the error, and the error claimed is the true one",
          "[separate][Sec3.2]") {
  const SnapshotTensor snapshots = dents(80, 11, 6);
  for (const bool update : {false, true}) {
    INFO("update_all " << update);
    const Separation result = greedy_pgd(snapshots, {.tolerance = 1e-4}, {.update_all = update});
    CHECK(result.reached);
    CHECK(result.errors.size() == result.separated.F.cols());
    for (Index m = 1; m < result.errors.size(); ++m) CHECK(result.errors[m] < result.errors[m - 1]);
    const double direct =
        (expand(result.separated) - snapshots.values).norm() / snapshots.values.norm();
    CHECK(direct <= 1e-4);
    CHECK(std::abs(direct - result.errors.tail(1)[0]) <= tolerance(1e-9, "rounding of sums"));
  }
}

TEST_CASE("updating all functions needs no more modes", "[separate][Sec3.2]") {
  const SnapshotTensor snapshots = dents(80, 13, 6);
  const auto modes = [&](bool update) {
    return greedy_pgd(snapshots, {.tolerance = 1e-4}, {.update_all = update}).separated.F.cols();
  };
  CHECK(modes(true) < modes(false));
}

TEST_CASE("functions of parameters have unit length and a positive largest value",
          "[separate][Sec3.2]") {
  const Separation result = greedy_pgd(dents(50, 9, 6), {.tolerance = 1e-3});
  for (const MatrixXd& G : result.separated.G) {
    for (Index i = 0; i < G.cols(); ++i) {
      CHECK(std::abs(G.col(i).norm() - 1.0) <= tolerance(1e-12, "rounding"));
      CHECK(G.col(i).maxCoeff() >= -G.col(i).minCoeff());
    }
  }
}

TEST_CASE("the number of modes can be bounded instead", "[separate][Sec3.2]") {
  const Separation result = greedy_pgd(dents(40, 7, 4), {.tolerance = 1e-6, .max_modes = 3});
  CHECK(result.separated.F.cols() == 3);
  CHECK_FALSE(result.reached);
}

TEST_CASE("snapshots that greedy PGD cannot reduce are refused", "[separate][Sec3.2]") {
  CHECK_THROWS_AS(greedy_pgd({MatrixXd::Zero(20, 6), {3, 2}}, {}), Error);
  CHECK_THROWS_AS(greedy_pgd({dents(20, 3, 2).values, {3, 3}}, {}), ContractViolation);
  CHECK_THROWS_AS(greedy_pgd(dents(20, 3, 2), {.max_modes = 0}), ContractViolation);
}

}  // namespace

}  // namespace palpable
