#include "palpable/live/stereo/standing_threads.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace palpable {
namespace {

TEST_CASE("a crew does each piece once, whatever its size", "[stereo][threads]") {
  for (const int size : {1, 2, 3}) {
    StandingThreads crew(size);
    CHECK(crew.size() == size);
    for (const int count : {0, 1, 2, 7, 64}) {
      for (int again = 0; again < 20; ++again) {
        std::array<std::atomic<int>, 64> done{};
        crew.run(count, [&](int i) { ++done[i]; });
        for (int i = 0; i < 64; ++i) REQUIRE(done[i] == (i < count));
      }
    }
  }
}

TEST_CASE("a crew that stands takes no memory", "[stereo]") {
  StandingThreads crew(2);
  std::atomic<int> sum = 0;
  crew.run(4, [&](int i) { sum += i; });
  CHECK(test::allocations_during([&] { crew.run(4, [&](int i) { sum += i; }); }) == 0);
  CHECK(sum == 12);
}

}  // namespace
}  // namespace palpable
