#include "palpable/common/base/time_stamps.h"

#include "tests/support/test.h"

#include <string>
#include <vector>

namespace palpable {
namespace {

// count times at this rate, in units of `per_second`
std::vector<double> stamps(double begin, double rate, double per_second, int count = 30) {
  std::vector<double> times;
  for (int k = 0; k < count; ++k) times.push_back(per_second * (begin + k / rate));
  return times;
}

constexpr double kToday = 1.7e9;  // s, Unix time

TEST_CASE("seconds of any clock and of any rate are seconds", "[base][times]") {
  for (const double begin : {0.0, 3600.0, kToday, -5.0}) {
    for (const double rate : {1000.0, 30.0, 1.0, 0.1, 0.005}) {
      INFO(begin << " s, " << rate << " Hz");
      CHECK(unit_of_times(stamps(begin, rate, 1)).empty());
    }
  }
  CHECK(unit_of_times({}).empty());
  CHECK(unit_of_times({kToday}).empty());
  CHECK(unit_of_times({0, 500, 500.1, 500.2}).empty());  // one long gap
}

TEST_CASE("nanoseconds and microseconds are named, whatever their clock and rate",
          "[base][times]") {
  for (const double begin : {0.0, 3600.0, kToday}) {
    for (const double rate : {200.0, 30.0, 2.0}) {
      INFO(begin << " s, " << rate << " Hz");
      CHECK(unit_of_times(stamps(begin, rate, 1e9)) == "nanoseconds");
      CHECK(unit_of_times(stamps(begin, rate, 1e6)) == "microseconds");
    }
  }
  CHECK(unit_of_times(stamps(kToday, 30, 1e3)) == "milliseconds");
  CHECK(unit_of_times({1e9 * kToday}) == "nanoseconds");
  CHECK_THAT(what_is_wrong_with_times(stamps(0, 10, 1e9, 100)),
             Catch::Contains("9900000000") && Catch::Contains("nanoseconds") &&
                 Catch::Contains("divide them by 1e9"));
  CHECK_THAT(what_is_wrong_with_times(stamps(0, 10, 1e6)), Catch::Contains("divide them by 1e6"));
  CHECK(what_is_wrong_with_times(stamps(0, 10, 1)).empty());
}

}  // namespace
}  // namespace palpable
