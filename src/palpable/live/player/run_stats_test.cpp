#include "palpable/live/player/run_stats.h"

#include "palpable/common/base/order_statistics.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace palpable {
namespace {

StageTimes times_of(double read, double draw) {
  StageTimes times;
  times.add("read", read);
  if (draw > 0) times.add("draw", draw);
  return times;
}

TEST_CASE("percentiles of binned durations are those of the durations, within 1 %", "[player]") {
  auto random = test::random_case(1);
  std::lognormal_distribution<double> some(3, 1.5);  // ms
  DurationBins bins;
  CHECK(bins.percentile(0.5) == 0);
  std::vector<double> durations;
  for (int i = 0; i < 5000; ++i) {
    durations.push_back(some(random));
    bins.add(durations.back());
  }
  CHECK(bins.count() == 5000);
  for (const double share : {0.0, 0.1, 0.5, 0.9, 0.99, 1.0}) {
    INFO(share);
    // 1 % for half a bin's width, and a little for the distance to the neighbouring durations.
    CHECK(bins.percentile(share) == Approx(percentile(durations, share)).epsilon(0.012));
  }
  bins.clear();
  for (const double odd : {-1.0, 0.0, 1e-9}) bins.add(odd);
  CHECK(bins.percentile(0.5) == Approx(0.001).epsilon(0.02));
  bins.clear();
  bins.add(std::numeric_limits<double>::infinity());
  CHECK(bins.percentile(0.5) > 2e5);
}

TEST_CASE("a run's figures are of all of it, a stretch's of what came since the last", "[player]") {
  RunStats stats({.now = 100, .cpu = 7, .dropped = 2});
  CHECK(test::allocations_during([&] {
          for (int i = 0; i < 20; ++i) stats.add(times_of(4, 8), 40);
        }) == 0);
  CHECK_FALSE(stats.is_second_over(100.9));
  CHECK(stats.is_second_over(101));
  const RunFigures first = stats.end_stretch({.now = 101, .cpu = 8, .dropped = 5, .left_out = 3});
  CHECK(first.frames == 20);
  CHECK(first.frames_per_second == Approx(20));
  CHECK(first.age_p50_ms == Approx(40).epsilon(0.01));
  CHECK(first.dropped == 3);
  CHECK(first.left_out == 3);
  CHECK(first.cpu_ms_per_frame == Approx(50));
  REQUIRE(first.stages.size() == 2);
  CHECK(first.stages[1].name == "draw");
  CHECK(first.stages[1].p50_ms == Approx(8).epsilon(0.01));
  CHECK_FALSE(stats.is_second_over(101.5));

  for (int i = 0; i < 10; ++i) stats.add(times_of(4, 0), 80);
  stats.add(times_of(4, 0), std::nan(""));  // the time of taking is unknown
  const RunFigures second =
      stats.end_stretch({.now = 103, .cpu = 8.11, .dropped = 5, .left_out = 4});
  CHECK(second.frames == 11);
  CHECK(second.frames_per_second == Approx(5.5));
  CHECK(second.age_p50_ms == Approx(80).epsilon(0.01));
  CHECK(second.dropped == 0);
  CHECK(second.left_out == 1);
  CHECK(second.cpu_ms_per_frame == Approx(10));
  CHECK(second.stages.size() == 1);

  const RunFigures all = stats.all({.now = 103, .cpu = 8.11, .dropped = 5, .left_out = 4});
  CHECK(all.frames == 31);
  CHECK(all.age_p50_ms == Approx(40).epsilon(0.01));
  CHECK(all.age_p99_ms == Approx(80).epsilon(0.01));
  CHECK(all.dropped == 3);
  CHECK(all.left_out == 4);
  CHECK(all.stages.size() == 2);
}

TEST_CASE("a line about a stretch in which nothing came is one", "[player]") {
  RunStats stats(RunMoment{});
  CHECK_THAT(text_of(stats.end_stretch({.now = 1})), Catch::Contains("0.0 frames/s"));
}

}  // namespace
}  // namespace palpable
