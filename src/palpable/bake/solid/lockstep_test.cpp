#include "palpable/bake/solid/lockstep.h"

#include "palpable/bake/solid/block_matrix.h"
#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

namespace palpable {
namespace {

using Eigen::VectorXd;

// A chain of nodes, each tied to the next; positive definite.
struct Chain {
  BlockPattern pattern;
  FactorWorkspace workspace;
  std::optional<CholeskyAnalysis> analysis;
  std::optional<CholeskyFactor> factor;

  explicit Chain(double stiffness, int nodes = 40) {
    pattern.row_start.push_back(0);
    for (int r = 0; r < nodes; ++r) {
      for (int c = std::max(0, r - 1); c <= std::min(nodes - 1, r + 1); ++c) {
        pattern.column.push_back(c);
      }
      pattern.row_start.push_back(static_cast<int>(pattern.column.size()));
    }
    BlockMatrix K(pattern);
    for (int r = 0; r < nodes; ++r) {
      K.block(pattern.find(r, r)) = 3.0 * stiffness * Eigen::Matrix3d::Identity();
      if (r > 0) {
        K.block(pattern.find(r, r - 1)) = -stiffness * Eigen::Matrix3d::Identity();
        K.block(pattern.find(r - 1, r)) = -stiffness * Eigen::Matrix3d::Identity();
      }
    }
    analysis.emplace(pattern, workspace);
    factor = CholeskyFactor::make(*analysis, K, FactorPrecision::k32Bits, workspace);
  }
  [[nodiscard]] VectorXd system(int item) const {
    return VectorXd::LinSpaced(3 * pattern.rows(), item + 1.0, -2.0 * item);
  }
};

std::function<std::optional<int>()> numbers(int count) {
  return [count, i = 0]() mutable { return i < count ? std::optional(i++) : std::nullopt; };
}

// The results of items that each make a different number of solves.
std::vector<VectorXd> solve_all(const Chain& soft, const Chain& stiff,
                                const LockstepSettings& settings) {
  constexpr int kItems = 37;
  std::vector<VectorXd> results(kItems);
  run_in_lockstep(
      numbers(kItems),
      [&](int item, Lane& lane) {
        VectorXd b = soft.system(item), x;
        for (int k = 0; k <= item % 5; ++k) {
          lane.solve(*(item % 3 == 0 ? stiff : soft).factor, b, x);
          b = x + 0.1 * b;
        }
        results[std::size_t(item)] = b;
      },
      settings);
  return results;
}

TEST_CASE("what a lane computes is the same to the bit however many share its passes",
          "[solid][lockstep][threads]") {
  const Chain soft(1.0), stiff(1e6);
  const std::vector<VectorXd> alone = solve_all(soft, stiff, {.threads = 1, .lanes = 1});
  for (const VectorXd& result : alone) CHECK(result.size() == 120);
  CHECK(solve_all(soft, stiff, {.threads = 1, .lanes = 16}) == alone);
  CHECK(solve_all(soft, stiff, {.threads = 2, .lanes = 7}) == alone);
  CHECK(solve_all(soft, stiff, {.threads = 3, .lanes = 48}) == alone);
}

TEST_CASE("a lane gets what the factor alone would have given it", "[solid][lockstep]") {
  Chain chain(2.0);
  std::vector<VectorXd> x(9);
  run_in_lockstep(numbers(9),
                  [&](int item, Lane& lane) {
                    lane.solve(*chain.factor, chain.system(item), x[std::size_t(item)]);
                  },
                  {.threads = 2, .lanes = 5});
  for (int item = 0; item < 9; ++item) {
    VectorXd alone;
    chain.factor->solve_roughly(chain.system(item), alone, chain.workspace);
    CHECK((x[std::size_t(item)] - alone).norm() <=
          test::tolerance(1e-5, "single precision, sums in another order") * alone.norm());
  }
}

TEST_CASE("no more lanes run at a time than there are threads, and passes are shared",
          "[solid][lockstep][threads]") {
  const Chain chain(1.0);
  std::atomic<int> running = 0, most = 0;
  run_in_lockstep(numbers(40),
                  [&](int item, Lane& lane) {
                    VectorXd x;
                    for (int k = 0; k < 10; ++k) {
                      const int now = ++running;
                      int before = most;
                      while (now > before && !most.compare_exchange_weak(before, now)) {}
                      const VectorXd b = chain.system(item + k);
                      --running;
                      lane.solve(*chain.factor, b, x);
                    }
                  },
                  {.threads = 2, .lanes = 20});
  CHECK(most >= 1);
  CHECK(most <= 2);
}

TEST_CASE("lanes that are least far go first", "[solid][lockstep]") {
  // On one thread the first 16 items share the first pass. Then the four run that had not begun,
  // and of the 16 those with the least progress, here the last ones, until 16 lanes wait again.
  const Chain chain(1.0);
  std::vector<int> order;
  const auto work = [&](int item, Lane& lane) {
    VectorXd x;
    lane.report_progress(1.0 - item / 20.0);
    lane.solve(*chain.factor, chain.system(item), x);
    order.push_back(item);
    lane.solve(*chain.factor, chain.system(item), x);
  };
  run_in_lockstep(numbers(20), work, {.threads = 1, .lanes = 20});
  REQUIRE(order.size() == 20);
  CHECK(std::vector<int>(order.begin(), order.begin() + 12) ==
        std::vector<int>{15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4});
}

TEST_CASE("an item that fails ends the run but not the items beside it", "[solid][lockstep]") {
  const Chain chain(1.0);
  std::mutex mutex;
  std::set<int> ended;
  const auto work = [&](int item, Lane& lane) {
    VectorXd x;
    for (int k = 0; k < 5; ++k) {
      lane.solve(*chain.factor, chain.system(item), x);
      if (k == 1 && (item == 2 || item == 5)) throw Error("item " + std::to_string(item));
    }
    const std::lock_guard lock(mutex);
    ended.insert(item);
  };
  CHECK_THROWS_WITH(run_in_lockstep(numbers(100), work, {.threads = 1, .lanes = 8}), "item 2");
  CHECK(ended == std::set<int>{0, 1, 3, 4, 6, 7});

  // The function that hands out the items may fail, too.
  const auto broken = []() -> std::optional<int> { throw std::runtime_error("no more news"); };
  CHECK_THROWS_WITH(run_in_lockstep(broken, work, {.threads = 2, .lanes = 4}), "no more news");
}

TEST_CASE("a system of the wrong size fails in its own lane", "[solid][lockstep]") {
  const Chain chain(1.0);
  std::atomic<int> good = 0;
  const auto work = [&](int item, Lane& lane) {
    VectorXd x;
    if (item == 3) {
      CHECK_THROWS(lane.solve(*chain.factor, VectorXd::Ones(7), x));
      return;
    }
    lane.solve(*chain.factor, chain.system(item), x);
    good += x.size() == 120;
  };
  run_in_lockstep(numbers(6), work, {.threads = 1, .lanes = 6});
  CHECK(good == 5);
}

}  // namespace
}  // namespace palpable
