#include "palpable/bake/separate/cp_als.h"

#include "palpable/bake/separate/greedy_pgd.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/tensors.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using Eigen::MatrixXd;
using test::random_case;
using test::random_separated;
using test::tolerance;

TEST_CASE("CP-ALS recovers a tensor of known rank with that many modes", "[separate][cp]") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    auto random = random_case(seed);
    const std::vector<int> sizes{8, 6};
    const SnapshotTensor tensor{expand(random_separated(40, sizes, 3, 0.6, random)), sizes};
    const Separation result = cp_als(tensor, {.tolerance = 1e-4, .max_modes = 3},
                                     {.max_sweeps = 500, .sweep_tolerance = 1e-6});
    CHECK(result.reached);
    CHECK(result.separated.F.cols() == 3);
    CHECK((expand(result.separated) - tensor.values).norm() <= 1e-4 * tensor.values.norm());
  }
}

TEST_CASE("CP-ALS needs at most as many modes as the greedy sweep it starts from",
          "[separate][cp]") {
  const SnapshotTensor tensor = test::hilbert(30, {9, 7});
  const auto greedy = greedy_pgd(tensor, {.tolerance = 1e-5}, {.update_all = false});
  const auto cp = cp_als(tensor, {.tolerance = 1e-5});
  CHECK(greedy.reached);
  CHECK(cp.reached);
  CHECK(cp.separated.F.cols() <= greedy.separated.F.cols());
  const double direct = (expand(cp.separated) - tensor.values).norm() / tensor.values.norm();
  CHECK(std::abs(direct - cp.errors.tail(1)[0]) <= tolerance(1e-9, "rounding of sums"));
}

TEST_CASE("a number of modes given to CP-ALS is spent on sweeps", "[separate][cp]") {
  const SnapshotTensor tensor = test::dents(40, 9, 5);
  const auto greedy =
      greedy_pgd(tensor, {.tolerance = 1e-9, .max_modes = 6}, {.update_all = false});
  const auto cp = cp_als(tensor, {.tolerance = 1e-9, .max_modes = 6});
  CHECK_FALSE(cp.reached);
  CHECK(cp.separated.F.cols() == 6);
  CHECK(cp.errors.tail(1)[0] < greedy.errors.tail(1)[0]);
}

TEST_CASE("what CP-ALS cannot reduce is refused", "[separate][cp]") {
  CHECK_THROWS_AS(cp_als({MatrixXd::Zero(20, 6), {3, 2}}, {}), Error);
  CHECK_THROWS_AS(cp_als(test::dents(20, 3, 2), {.max_modes = 0}), ContractViolation);
}

}  // namespace
}  // namespace palpable
