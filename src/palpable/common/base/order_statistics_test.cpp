#include "palpable/common/base/order_statistics.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("the median is the middle value, or the mean of the middle two", "[base]") {
  CHECK(percentile({3, 1, 2}, 0.5) == 2);
  CHECK(percentile({4, 1, 2, 3}, 0.5) == 2.5);
  CHECK(percentile({7}, 0.5) == 7);
}

TEST_CASE("shares 0 and 1 are the least and the largest, and others lie linearly between",
          "[base]") {
  CHECK(percentile({5, 9, 1}, 0) == 1);
  CHECK(percentile({5, 9, 1}, 1) == 9);
  std::vector<double> hundred_and_one;
  for (int i = 100; i >= 0; --i) hundred_and_one.push_back(2.0 * i);
  CHECK(percentile(hundred_and_one, 0.99) == Approx(198).epsilon(1e-12));
}

TEST_CASE("the upper median is one of the values, of an even number the larger of the middle two",
          "[base]") {
  std::vector<float> four{4, 1, 2, 3};
  CHECK(upper_median(four) == 3);
  std::vector<double> three{9, 1, 5};
  CHECK(upper_median(three) == 5);
  std::vector<int> one{7};
  CHECK(upper_median(one) == 7);
}

TEST_CASE("a percentile of no values is refused", "[base][errors]") {
  CHECK_THROWS_AS(percentile({}, 0.5), ContractViolation);
  CHECK_THROWS_AS(percentile({1}, 1.1), ContractViolation);
}

TEST_CASE("a histogram gives the bin of a percentile, its ends included", "[base]") {
  const std::array<std::uint32_t, 5> bins{0, 2, 0, 1, 1};  // of the values 1, 1, 3, 4
  CHECK(percentile_bin(bins, 4, 0.0) == 1);
  CHECK(percentile_bin(bins, 4, 0.5) == 1);  // rank 1.5: the lower of the middle two
  CHECK(percentile_bin(bins, 4, 0.67) == 3);
  CHECK(percentile_bin(bins, 4, 1.0) == 4);
  const std::array<std::uint32_t, 5> odd{1, 0, 1, 0, 1};
  CHECK(percentile_bin(odd, 3, 0.5) == 2);
}

}  // namespace
}  // namespace palpable
