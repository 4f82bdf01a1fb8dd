#include "palpable/live/track/disparity_watch.h"

#include "tests/support/test.h"

#include <array>

namespace palpable {
namespace {

constexpr double kOfSigma01 = 100;  // 1/px^2, the information of a sigma of 0.1 px

TEST_CASE("an error of all disparities is believed when two adjustments agree on it", "[track]") {
  DisparityWatch watch;
  CHECK_FALSE(watch.add(-1.1, kOfSigma01, 0));
  CHECK(watch.add(-1.2, kOfSigma01, 0) == -1.2);
  // What is left of it, to the same side.
  CHECK(watch.add(-1.5, kOfSigma01, -1.2) == -1.5);
  CHECK(watch.add(-1.5, kOfSigma01, -1.2) == -1.5);
  CHECK_FALSE(watch.add(-1.6, kOfSigma01, -1.5));  // less than 0.2 px
  CHECK_FALSE(watch.add(-1.6, kOfSigma01, -1.5));
}

TEST_CASE("no error is believed that is small, uncertain, changing or too large", "[track]") {
  for (const auto& [first, second, information] :
       {std::array{0.3, 0.3, kOfSigma01}, std::array{1.0, 1.0, kOfSigma01 / 10},
        std::array{1.0, -1.0, kOfSigma01}, std::array{1.0, 0.1, kOfSigma01},
        std::array{5.0, 5.0, kOfSigma01}, std::array{1.0, 1.0, 0.0}}) {
    INFO(first << " px, then " << second << " px");
    DisparityWatch watch;
    CHECK_FALSE(watch.add(first, information, 0));
    CHECK_FALSE(watch.add(second, information, 0));
  }
}

}  // namespace
}  // namespace palpable
