#include "palpable/bake/greedy_pgd.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "tests/support/test.h"

#include <Eigen/SVD>

#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::random_case;
using test::tolerance;

MatrixXd random_matrix(Index rows, Index columns, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  MatrixXd A(rows, columns);
  for (double& x : A.reshaped()) x = normal(random);
  return A;
}

VectorXd random_weights(Index n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.5, 2.0);
  VectorXd w(n);
  for (double& x : w) x = uniform(random);
  return w;
}

// A sum of `rank` separated terms, each `ratio` times as large as the one before.
SeparatedTensor random_separated(Index N, const std::vector<int>& sizes, Index rank, double ratio,
                                 std::mt19937_64& random) {
  SeparatedTensor separated{random_matrix(N, rank, random), {}};
  for (const int n : sizes) separated.G.push_back(random_matrix(n, rank, random));
  for (Index i = 0; i < rank; ++i) separated.F.col(i) *= std::pow(ratio, static_cast<double>(i));
  return separated;
}

// A pressed body in miniature: a dent at a place that the first parameter chooses, growing with the
// second, more than in proportion. Its rank is full, as a body's is.
SnapshotTensor dents(int N, int sites, int levels) {
  SnapshotTensor snapshots{MatrixXd(N, sites * levels), {sites, levels}};
  for (int s = 0; s < sites; ++s) {
    for (int l = 0; l < levels; ++l) {
      const double place = (s + 0.5) / sites, depth = (l + 1.0) / levels;
      for (int n = 0; n < N; ++n) {
        const double x = (n + 0.5) / N - place;
        snapshots.values(n, s * levels + l) =
            depth * std::exp(-40.0 * x * x * (1.0 + 0.4 * depth)) + 0.2 * depth * depth * x;
      }
    }
  }
  return snapshots;
}

double pooled_error(const SnapshotTensor& snapshots, const SeparatedTensor& separated,
                    const VectorXd& w) {
  // Term by term, with nothing of the code under test.
  double lost = 0, whole = 0;
  const Index levels = snapshots.sizes[1];
  for (Index k = 0; k < snapshots.values.cols(); ++k) {
    for (Index n = 0; n < snapshots.values.rows(); ++n) {
      double u = 0;
      for (Index i = 0; i < separated.F.cols(); ++i) {
        u += separated.F(n, i) * separated.G[0](k / levels, i) * separated.G[1](k % levels, i);
      }
      const double a = snapshots.values(n, k);
      lost += w[n] * (a - u) * (a - u);
      whole += w[n] * a * a;
    }
  }
  return std::sqrt(lost / whole);
}

TEST_CASE("a tensor that is one separated term is found with one mode", "[bake][Sec3.2]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const std::vector<int> sizes{4, 3, 2};
    const SnapshotTensor snapshots{expand(random_separated(30, sizes, 1, 1.0, random)), sizes};
    const GreedyResult result =
        separate(snapshots, random_weights(30, random), {.tolerance = 1e-6});
    CHECK(result.separated.F.cols() == 1);
    CHECK(result.error <= tolerance(1e-7, "the Gram matrix keeps half of the digits"));
  }
}

TEST_CASE("a tensor of known rank is recovered", "[bake][Sec3.2]") {
  for (unsigned seed = 0; seed < 10; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const std::vector<int> sizes{7, 5};
    const SeparatedTensor truth = random_separated(60, sizes, 3, 0.3, random);
    const SnapshotTensor snapshots{expand(truth), sizes};
    const GreedyResult result =
        separate(snapshots, random_weights(60, random), {.tolerance = 1e-4, .max_modes = 12});
    CHECK(result.reached);
    const MatrixXd left = expand(result.separated) - snapshots.values;
    CHECK(left.norm() <= tolerance(3e-4, "the asked 1e-4 in a norm of weights 0.5 .. 2") *
                             snapshots.values.norm());
  }
}

TEST_CASE("with one parameter the greedy modes are those of the singular value decomposition",
          "[bake][Sec3.2]") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    // Separated singular values, so that alternating directions (a power iteration) converge.
    const MatrixXd A = expand(random_separated(40, {9}, 5, 0.2, random));
    const Eigen::VectorXd s = Eigen::JacobiSVD<MatrixXd>(A).singularValues();
    const GreedyResult result = separate(
        {A, {9}}, VectorXd::Ones(40), {.tolerance = 1e-6, .max_modes = 4, .pass_tolerance = 1e-9});
    for (Index m = 1; m <= result.errors.size(); ++m) {
      const double best = s.tail(s.size() - m).norm() / s.norm();  // Eckart and Young
      CHECK(result.errors[m - 1] >= best - tolerance(1e-9, "rounding"));
      CHECK(result.errors[m - 1] <=
            best * (1 + tolerance(1e-3, "power iterations stop early")) +
                tolerance(1e-7, "the Gram matrix keeps half of the digits"));
    }
  }
}

TEST_CASE("each further mode lowers the error, and the error claimed is the true one",
          "[bake][Sec3.2]") {
  const SnapshotTensor snapshots = dents(80, 11, 6);
  auto random = random_case(1);
  const VectorXd w = random_weights(80, random);
  for (const bool update : {false, true}) {
    INFO("update_all " << update);
    const GreedyResult result = separate(snapshots, w, {.tolerance = 1e-4, .update_all = update});
    CHECK(result.reached);
    CHECK(result.errors.size() == result.separated.F.cols());
    for (Index m = 1; m < result.errors.size(); ++m) CHECK(result.errors[m] < result.errors[m - 1]);
    const double direct = pooled_error(snapshots, result.separated, w);
    CHECK(direct <= 1e-4);
    CHECK(std::abs(direct - result.error) <= tolerance(1e-9, "rounding of sums"));
    CHECK(std::abs(direct - result.errors.tail(1)[0]) <=
          tolerance(1e-7, "what the Gram matrix drops"));
  }
}

TEST_CASE("updating all functions needs no more modes", "[bake][Sec3.2]") {
  const SnapshotTensor snapshots = dents(80, 13, 6);
  const VectorXd w = VectorXd::Ones(80);
  const auto modes = [&](bool update) {
    return separate(snapshots, w, {.tolerance = 1e-4, .update_all = update}).separated.F.cols();
  };
  CHECK(modes(true) < modes(false));
}

TEST_CASE("the error of each snapshot is in its own norm", "[bake][Sec3.2]") {
  SnapshotTensor snapshots = dents(50, 6, 4);
  snapshots.values.col(7).setZero();
  const VectorXd w = VectorXd::LinSpaced(50, 1.0, 3.0);
  const GreedyResult result = separate(snapshots, w, {.tolerance = 1e-2});
  const MatrixXd left = snapshots.values - expand(result.separated);
  for (Index k = 0; k < 24; ++k) {
    INFO("snapshot " << k);
    const double own = k == 7 ? 0.0
                              : std::sqrt(left.col(k).cwiseAbs2().dot(w) /
                                          snapshots.values.col(k).cwiseAbs2().dot(w));
    CHECK(std::abs(result.snapshot_errors[k] - own) <= tolerance(1e-12, "rounding"));
  }
}

TEST_CASE("the greedy sweep in POD coordinates is the one in full space", "[bake][Sec3.2]") {
  const SnapshotTensor snapshots = dents(70, 9, 5);
  auto random = random_case(2);
  const VectorXd w = random_weights(70, random);
  for (const bool update : {false, true}) {
    INFO("update_all " << update);
    const GreedySettings settings{.tolerance = 1e-3, .update_all = update};
    const GreedyResult fast = separate(snapshots, w, settings);
    const GreedyResult slow = separate_in_full_space(snapshots, w, settings);
    REQUIRE(fast.errors.size() == slow.errors.size());
    for (Index m = 0; m < fast.errors.size(); ++m) {
      CHECK(std::abs(fast.errors[m] - slow.errors[m]) <=
            tolerance(1e-6, "rounding, grown by the passes, times the error") * slow.errors[m]);
    }
    const double difference = (fast.separated.F - slow.separated.F).norm();
    CHECK(difference <=
          tolerance(1e-5, "the Gram matrix keeps half of the digits") * slow.separated.F.norm());
  }
}

TEST_CASE("the same snapshots give the same modes to the last bit", "[bake][Sec3.2]") {
  const SnapshotTensor snapshots = dents(40, 7, 4);
  const VectorXd w = VectorXd::Ones(40);
  CHECK(separate(snapshots, w, {}).separated.F == separate(snapshots, w, {}).separated.F);
}

TEST_CASE("the number of modes can be bounded instead", "[bake][Sec3.2]") {
  const GreedyResult result =
      separate(dents(40, 7, 4), VectorXd::Ones(40), {.tolerance = 1e-6, .max_modes = 3});
  CHECK(result.separated.F.cols() == 3);
  CHECK_FALSE(result.reached);
}

TEST_CASE("snapshots that cannot be reduced are refused", "[bake][Sec3.2]") {
  SnapshotTensor snapshots = dents(20, 3, 2);
  const VectorXd w = VectorXd::Ones(20);
  CHECK_THROWS_AS(separate({MatrixXd::Zero(20, 6), {3, 2}}, w, {}), Error);
  CHECK_THROWS_AS(separate({snapshots.values, {3, 3}}, w, {}), ContractViolation);
  CHECK_THROWS_AS(separate(snapshots, VectorXd::Ones(19), {}), ContractViolation);
  CHECK_THROWS_AS(separate(snapshots, VectorXd::Zero(20), {}), ContractViolation);
  CHECK_THROWS_AS(separate(snapshots, w, {.tolerance = 1e-9}), ContractViolation);
  snapshots.values(3, 4) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(separate(snapshots, w, {}), Error);
}

}  // namespace
}  // namespace palpable
