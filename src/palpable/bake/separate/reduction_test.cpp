#include "palpable/bake/separate/reduction.h"

#include "palpable/bake/separate/greedy_pgd.h"
#include "palpable/bake/separate/pod.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::dents;
using test::random_case;
using test::random_weights;
using test::tolerance;

constexpr ReductionMethod kAll[] = {ReductionMethod::kPerSite, ReductionMethod::kPgd,
                                    ReductionMethod::kPgd2,    ReductionMethod::kPod,
                                    ReductionMethod::kCp,      ReductionMethod::kHosvd};

// (K) squared norms of each snapshot's residual and of the snapshot, term by term.
std::pair<VectorXd, VectorXd> squares(const MatrixXd& A, const MatrixXd& reduced,
                                      const VectorXd& w) {
  VectorXd lost = VectorXd::Zero(A.cols()), whole = lost;
  for (Index k = 0; k < A.cols(); ++k) {
    for (Index n = 0; n < A.rows(); ++n) {
      lost[k] += w[n] * (A(n, k) - reduced(n, k)) * (A(n, k) - reduced(n, k));
      whole[k] += w[n] * A(n, k) * A(n, k);
    }
  }
  return {lost, whole};
}

TEST_CASE("every method meets its tolerance in the weighted norm, and claims the true errors",
          "[separate][reduction]") {
  SnapshotTensor snapshots = dents(60, 9, 6);
  snapshots.values.col(7).setZero();
  auto random = random_case(1);
  const VectorXd w = random_weights(60, random);
  for (const ReductionMethod method : kAll) {
    INFO(method_name(method));
    const Reduction result = reduce(rows_of(snapshots), w, {.method = method, .tolerance = 1e-4});
    CHECK(result.reached);
    const auto [lost, whole] = squares(snapshots.values, expand(result, snapshots.sizes), w);
    const double pooled = std::sqrt(lost.sum() / whole.sum());
    CHECK(pooled <= 1e-4 * (1 + tolerance(1e-6, "what the Gram matrix drops")));
    CHECK(std::abs(pooled - result.error) <= tolerance(1e-10, "rounding of sums"));
    for (Index k = 0; k < lost.size(); ++k) {
      const double own = k == 7 ? 0.0 : std::sqrt(lost[k] / whole[k]);
      CHECK(std::abs(result.snapshot_errors[k] - own) <= tolerance(1e-9, "rounding of sums"));
    }
    if (method != ReductionMethod::kHosvd) {
      CHECK(result.errors.size() == result.most_modes());
      CHECK(result.errors.tail(1)[0] <= 1e-4);
    }
    if (method == ReductionMethod::kHosvd) {
      CHECK(result.ranks.size() == 3);
      CHECK(*result.bound <= 1e-4);
      CHECK(result.ranks[0] == result.most_modes());
    }
  }
}

TEST_CASE("no method beats POD's number of modes, and PGD in two factors has it",
          "[separate][reduction]") {
  const SnapshotTensor snapshots = dents(80, 12, 6);
  auto random = random_case(2);
  const VectorXd w = random_weights(80, random);
  const auto modes = [&](ReductionMethod method) {
    return reduce(rows_of(snapshots), w, {.method = method, .tolerance = 1e-3}).most_modes();
  };
  const int best = modes(ReductionMethod::kPod);
  CHECK(modes(ReductionMethod::kPgd2) <= best + 1);
  CHECK(modes(ReductionMethod::kPgd) >= best);
  CHECK(modes(ReductionMethod::kCp) >= best);
  CHECK(modes(ReductionMethod::kHosvd) >= best);
}

TEST_CASE("with blocks every site meets the tolerance, and with as few modes as POD needs for it",
          "[separate][reduction]") {
  SnapshotTensor snapshots = dents(60, 5, 6);
  // One site's fields are a thousand times smaller: an error over all snapshots together would not
  // show that this site is badly reduced.
  snapshots.values.middleCols(2 * 6, 6) *= 1e-3;
  const VectorXd w = VectorXd::Ones(60);
  const Reduction result = reduce(rows_of(snapshots), w, {.tolerance = 1e-3});
  REQUIRE(result.blocks.size() == 5);
  const MatrixXd reduced = expand(result, snapshots.sizes);
  for (Index s = 0; s < 5; ++s) {
    const MatrixXd A = snapshots.values.middleCols(s * 6, 6);
    CHECK((reduced.middleCols(s * 6, 6) - A).norm() <= 1e-3 * A.norm());
    const Reduction alone =
        reduce(rows_of({A, {6}}), w, {.method = ReductionMethod::kPod, .tolerance = 1e-3});
    CHECK(result.blocks[s].F.cols() == alone.most_modes());
  }
}

TEST_CASE("the errors of blocks are those of the worst site at each number of modes",
          "[separate][reduction]") {
  const SnapshotTensor snapshots = dents(60, 5, 6);
  const VectorXd w = VectorXd::Ones(60);
  const Reduction result = reduce(rows_of(snapshots), w, {.tolerance = 1e-5});
  for (int m = 1; m <= result.errors.size(); ++m) {
    double worst = 0;
    for (Index s = 0; s < 5; ++s) {
      const SnapshotTensor here{snapshots.values.middleCols(s * 6, 6), {6}};
      const int own = static_cast<int>(result.blocks[s].F.cols());
      worst = std::max(worst, reduce(rows_of(here), w,
                                     {.method = ReductionMethod::kPod,
                                      .tolerance = 1e-6,
                                      .max_modes = std::min(m, own)})
                                  .error);
    }
    CHECK(std::abs(result.errors[m - 1] - worst) <= tolerance(1e-8, "what the Gram matrix drops"));
  }
}

TEST_CASE("the course of a reduction holds the errors of reductions that stop earlier",
          "[separate][reduction]") {
  const SnapshotTensor snapshots = dents(60, 9, 6);
  auto random = random_case(4);
  const VectorXd w = random_weights(60, random);
  for (const ReductionMethod method : kAll) {
    for (const bool own : {false, true}) {
      INFO(method_name(method) << " own " << own);
      ReductionSettings settings{.method = method, .tolerance = 1e-4, .weight_snapshots = own};
      const Reduction full = reduce(rows_of(snapshots), w, settings);
      REQUIRE(full.course.rows() == full.most_modes());
      REQUIRE(full.pooled_course.size() == full.most_modes());
      CHECK(full.course.bottomRows(1).transpose() == full.snapshot_errors);
      CHECK(full.pooled_course.tail(1)[0] == full.error);
      // Not true of CP, which runs all its sweeps when it may add no further mode, nor of a Tucker
      // form, whose ranks are chosen together.
      if (method == ReductionMethod::kCp || method == ReductionMethod::kHosvd) continue;
      for (int m = 1; m < full.most_modes(); ++m) {
        settings.max_modes = m;
        const Reduction stopped = reduce(rows_of(snapshots), w, settings);
        CHECK(std::abs(full.pooled_course[m - 1] - stopped.error) <=
              tolerance(1e-6, "what the Gram matrix drops"));
        CHECK(
            (full.course.row(m - 1).transpose() - stopped.snapshot_errors).cwiseAbs().maxCoeff() <=
            tolerance(1e-5, "what the Gram matrix drops, of the smallest"));
      }
    }
  }
}

TEST_CASE("blocks over two parameters have functions of each of the two", "[separate][reduction]") {
  const SnapshotTensor flat = dents(50, 4, 6);
  const std::vector<int> sizes{4, 6, 3};
  SnapshotTensor snapshots{MatrixXd(50, 4 * 6 * 3), sizes};
  for (Index k = 0; k < 24; ++k) {
    for (Index e = 0; e < 3; ++e) {
      snapshots.values.col(3 * k + e) =
          flat.values.col(k) * std::pow(0.5, static_cast<double>(e)) +
          0.1 * flat.values.col(k).cwiseAbs2() * static_cast<double>(e);
    }
  }
  const Reduction result = reduce(rows_of(snapshots), VectorXd::Ones(50), {.tolerance = 1e-3});
  REQUIRE(result.blocks.size() == 4);
  for (const SeparatedTensor& block : result.blocks) {
    REQUIRE(block.G.size() == 2);
    CHECK(block.G[0].rows() == 6);
    CHECK(block.G[1].rows() == 3);
  }
  CHECK((expand(result, sizes) - snapshots.values).norm() <= 1e-3 * snapshots.values.norm());
}

TEST_CASE("modes over all parameters together become blocks that reproduce the same snapshots",
          "[separate][reduction]") {
  const SnapshotTensor snapshots = dents(60, 5, 6);
  auto random = random_case(4);
  const VectorXd w = random_weights(60, random);
  const Reduction joint =
      reduce(rows_of(snapshots), w, {.method = ReductionMethod::kPod, .tolerance = 1e-4});
  const MatrixXd whole = expand(joint, snapshots.sizes);
  for (const double lose : {1e-12, 1e-2}) {
    INFO("lose " << lose);
    const std::vector<SeparatedTensor> blocks = as_blocks(joint.blocks[0], 5, w, lose);
    REQUIRE(blocks.size() == 5);
    for (Index s = 0; s < 5; ++s) {
      const SeparatedTensor& block = blocks[s];
      const MatrixXd here = whole.middleCols(s * 6, 6);
      const auto norm = [&](const MatrixXd& A) {
        return std::sqrt((A.cwiseAbs2().transpose() * w).sum());
      };
      CHECK(norm(expand(block) - here) <=
            (lose + tolerance(1e-9, "the Gram matrix keeps half of the digits")) * norm(here));
      CHECK(block.F.cols() <= (lose > 1e-3 ? 3 : 6));
    }
  }
}

TEST_CASE("weighted by their own norms, small snapshots are as accurate as large ones",
          "[separate][reduction]") {
  const SnapshotTensor snapshots = dents(80, 8, 10);
  const VectorXd w = VectorXd::Ones(80);
  for (const ReductionMethod method : {ReductionMethod::kPerSite, ReductionMethod::kPgd,
                                       ReductionMethod::kPod, ReductionMethod::kHosvd}) {
    INFO(method_name(method));
    const auto worst = [&](bool weighted) {
      return reduce(rows_of(snapshots), w,
                    {.method = method, .tolerance = 3e-3, .weight_snapshots = weighted})
          .snapshot_errors;
    };
    CHECK(worst(true).maxCoeff() < 0.6 * worst(false).maxCoeff());
    if (method == ReductionMethod::kPod) {
      // With one table of functions the scale is exact, and the tolerance bounds the root mean
      // square of the snapshots' own relative errors.
      const VectorXd own = worst(true);
      CHECK(std::sqrt(own.squaredNorm() / static_cast<double>(own.size())) <= 3e-3);
    }
  }
}

TEST_CASE("norms that are separated are found, others nearly", "[separate][reduction]") {
  VectorXd norms(6);
  for (Index s = 0; s < 2; ++s) {
    for (Index l = 0; l < 3; ++l) {
      norms[s * 3 + l] = (1.0 + static_cast<double>(s)) * (2.0 + static_cast<double>(l));
    }
  }
  const std::vector<VectorXd> factors = separated_norms(norms, {2, 3});
  for (Index s = 0; s < 2; ++s) {
    for (Index l = 0; l < 3; ++l) {
      CHECK(std::abs(factors[0][s] * factors[1][l] - norms[s * 3 + l]) <=
            tolerance(1e-12, "rounding"));
    }
  }
  norms[4] = 0.0;
  for (const VectorXd& factor : separated_norms(norms, {2, 3})) CHECK(factor.minCoeff() > 0.0);
}

TEST_CASE("the greedy sweep in POD coordinates is the one in full space", "[separate][Sec3.2]") {
  const SnapshotTensor snapshots = dents(70, 9, 5);
  auto random = random_case(2);
  const VectorXd root = random_weights(70, random).cwiseSqrt();
  const SnapshotTensor weighted{root.asDiagonal() * snapshots.values, snapshots.sizes};
  const PodCoordinates Q =
      pod_coordinates(gram_of(rows_of(snapshots), root.cwiseAbs2()), VectorXd::Ones(45), 0.0);
  for (const bool update : {false, true}) {
    INFO("update_all " << update);
    const GreedySettings settings{.update_all = update};
    const Separation fast = greedy_pgd({Q.C, snapshots.sizes}, {.tolerance = 1e-3}, settings);
    const Separation slow = greedy_pgd(weighted, {.tolerance = 1e-3}, settings);
    REQUIRE(fast.errors.size() == slow.errors.size());
    for (Index m = 0; m < fast.errors.size(); ++m) {
      CHECK(std::abs(fast.errors[m] - slow.errors[m]) <=
            tolerance(1e-6, "rounding, grown by the passes, times the error") * slow.errors[m]);
    }
    const MatrixXd F = root.asDiagonal() * snapshots.values * (Q.combination * fast.separated.F);
    CHECK((F - slow.separated.F).norm() <=
          tolerance(1e-5, "the Gram matrix keeps half of the digits") * slow.separated.F.norm());
  }
}

TEST_CASE("POD coordinates leave out what they are allowed to", "[separate][reduction]") {
  const SnapshotTensor snapshots = dents(70, 9, 5);
  const MatrixXd gram = gram_of(rows_of(snapshots), VectorXd::Ones(70));
  const VectorXd ones = VectorXd::Ones(45);
  const PodCoordinates all = pod_coordinates(gram, ones, 0.0),
                       some = pod_coordinates(gram, ones, 1e-3);
  CHECK(some.C.rows() < all.C.rows());
  CHECK(some.lost <= 1e-3);
  const MatrixXd left = snapshots.values - snapshots.values * some.combination * some.C;
  CHECK(std::abs(left.norm() / snapshots.values.norm() - some.lost) <=
        tolerance(1e-7, "the Gram matrix keeps half of the digits"));
}

TEST_CASE("the same snapshots give the same modes to the last bit", "[separate][Sec3.2]") {
  const SnapshotTensor snapshots = dents(40, 7, 4);
  const VectorXd w = VectorXd::Ones(40);
  for (const ReductionMethod method : kAll) {
    INFO(method_name(method));
    const ReductionSettings settings{.method = method};
    CHECK(reduce(rows_of(snapshots), w, settings).blocks[0].F ==
          reduce(rows_of(snapshots), w, settings).blocks[0].F);
  }
}

TEST_CASE("a method has one name", "[separate][reduction]") {
  for (const ReductionMethod method : kAll) CHECK(method_named(method_name(method)) == method);
  CHECK_FALSE(method_named("svd"));
  CHECK(method_names().size() == std::size(kAll));
}

TEST_CASE("snapshots that cannot be reduced are refused", "[separate][reduction]") {
  SnapshotTensor snapshots = dents(20, 3, 2);
  const VectorXd w = VectorXd::Ones(20);
  for (const ReductionMethod method : kAll) {
    INFO(method_name(method));
    const ReductionSettings settings{.method = method};
    CHECK_THROWS_AS(reduce(rows_of({MatrixXd::Zero(20, 6), {3, 2}}), w, settings), Error);
    CHECK_THROWS_AS(reduce(rows_of(snapshots), VectorXd::Ones(19), settings), ContractViolation);
    CHECK_THROWS_AS(reduce(rows_of(snapshots), VectorXd::Zero(20), settings), ContractViolation);
    CHECK_THROWS_AS(reduce(rows_of(snapshots), w, {.method = method, .tolerance = 1e-9}),
                    ContractViolation);
  }
  CHECK_THROWS_AS(rows_of({snapshots.values, {3, 3}}), ContractViolation);
  snapshots.values(3, 4) = std::numeric_limits<double>::quiet_NaN();
  for (const ReductionMethod method : kAll) {
    CHECK_THROWS_AS(reduce(rows_of(snapshots), w, {.method = method}), Error);
  }
}

}  // namespace
}  // namespace palpable
