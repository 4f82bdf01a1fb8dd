#include "palpable/live/sources/natural_order.h"

#include "tests/support/test.h"

#include <algorithm>
#include <string>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("names are sorted as a person counts", "[sources][natural_order]") {
  const std::vector<std::string> sorted = {"a",
                                           "a0",
                                           "a1.png",
                                           "a02.png",
                                           "a2.png",
                                           "a10.png",
                                           "a10b2",
                                           "a10b11",
                                           "b",
                                           "b99999999999999999999998",
                                           "b99999999999999999999999",
                                           "b100000000000000000000000"};
  std::vector<std::string> names(sorted.rbegin(), sorted.rend());
  std::sort(names.begin(), names.end(),
            [](const std::string& a, const std::string& b) { return natural_less(a, b); });
  CHECK(names == sorted);
}

TEST_CASE("the order of names is strict, whatever the names", "[sources][natural_order][law]") {
  std::vector<std::string> names;
  for (const char* a : {"", "0", "00", "1", "01", "x"}) {
    for (const char* b : {"", "y", "7", "y07", "y7"}) names.push_back(std::string(a) + b);
  }
  for (const auto& a : names) {
    CHECK_FALSE(natural_less(a, a));
    for (const auto& b : names) {
      INFO(a << " and " << b);
      CHECK((a == b) == (!natural_less(a, b) && !natural_less(b, a)));
      CHECK_FALSE((natural_less(a, b) && natural_less(b, a)));
      for (const auto& c : names) {
        const bool broken = natural_less(a, b) && natural_less(b, c) && !natural_less(a, c);
        if (broken) FAIL(a << " < " << b << " < " << c << " but not " << a << " < " << c);
      }
    }
  }
}

}  // namespace
}  // namespace palpable
