#include "palpable/common/base/parallel_work.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <atomic>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("each item is worked on once, whatever the number of threads", "[base]") {
  for (const int threads : {1, 3, 50}) {
    std::vector<std::atomic<int>> worked(20);
    std::vector<double> told;
    work_in_parallel(
        20, threads, "counting",
        [&](const ProgressReport& now) {
          CHECK(now.task == "counting");
          told.push_back(now.done);
        },
        [&](int item) { ++worked[static_cast<std::size_t>(item)]; });
    for (const std::atomic<int>& count : worked) CHECK(count == 1);
    REQUIRE(told.size() == 20);
    for (std::size_t k = 0; k < 20; ++k) CHECK(told[k] == static_cast<double>(k + 1));
  }
  work_in_parallel(0, 4, "nothing", {}, [](int) { FAIL("there is no item"); });
}

TEST_CASE("after an error no further item begins, and the error is thrown again", "[base]") {
  std::atomic<int> begun{0};
  const auto work = [&](int item) {
    ++begun;
    if (item == 3) throw Error("the fourth");
  };
  CHECK_THROWS_WITH(work_in_parallel(1000, 1, "failing", {}, work), "the fourth");
  CHECK(begun == 4);
  CHECK_THROWS_WITH(work_in_parallel(1000, 4, "failing", {}, work), "the fourth");
}

TEST_CASE("a report that throws ends the work like an error of the work", "[base]") {
  for (const int threads : {1, 2, 4}) {
    std::atomic<int> begun{0};
    const auto stop_at_third = [](const ProgressReport& now) {
      if (now.done == 3) throw Error("stopped");
    };
    CHECK_THROWS_WITH(
        work_in_parallel(1000, threads, "stopping", stop_at_third, [&](int) { ++begun; }),
        "stopped");
    CHECK(begun < 1000);
  }
}

}  // namespace
}  // namespace palpable
